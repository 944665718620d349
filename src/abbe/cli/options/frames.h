/// Sequences of images: which frames, and what their files are called.
#pragma once

#include <cstdint>
#include <string>

namespace abbe {

/// Frames first to last, both included.
struct FrameRange {
  std::uint32_t first = 0, last = 0;
};

/// `A:B`, whole numbers. Errors: a usage Error at --frames, also for B < A and for more than 100
/// 000.
FrameRange parse_frames(const std::string& text);

/// The name of one frame's file: the number takes the place of the last run of # in the file's own
/// name, with zeros before it up to the length of the run.
/// Errors: a usage Error at `option` for a name without #, which every frame would overwrite.
std::string frame_file(const std::string& file, std::uint32_t frame, const std::string& option);

}  // namespace abbe
