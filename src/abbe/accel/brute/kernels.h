/// One ray against many blocks of triangles at the instruction set level of the machine.
#pragma once

#include <span>

#include "abbe/accel/leaf/block.h"
#include "abbe/accel/leaf/search.h"
#include "abbe/accel/leaf/shear.h"

namespace abbe {

/// Shows the search all triangles of loose blocks that lie behind each other. Errors: none.
void test_blocks(std::span<const BlockLine> blocks, const ShearedRay& ray, NearestSearch& search);
void test_blocks(std::span<const BlockLine> blocks, const ShearedRay& ray, AllSearch& search);

}  // namespace abbe
