/// The instruction set level at run time. Highway chooses the best of the machine;
/// ABBE_ISA=sse4|avx2|avx512 forces a level.
#pragma once

#include <string>

namespace abbe {

/// Reads ABBE_ISA and limits Highway's dispatch to it. Call once, before any parallel work.
/// Errors: a usage Error when the name is unknown or the machine lacks that level.
void apply_isa_from_environment();

/// "sse4", "avx2" or "avx512": the level that dispatched code runs at.
std::string isa_level();

}  // namespace abbe
