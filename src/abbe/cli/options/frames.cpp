#include "abbe/cli/options/frames.h"

#include <fmt/format.h>

#include "abbe/base/error.h"
#include "abbe/base/text.h"

namespace abbe {

FrameRange parse_frames(const std::string& text) {
  constexpr std::uint32_t kMostFrames = 100000, kLargest = 999999999;
  const std::size_t colon = text.find(':');
  const auto first = whole_u32_of(text.substr(0, colon));
  const auto last = whole_u32_of(colon == std::string::npos ? "" : text.substr(colon + 1));
  if (!first || !last || *last < *first || *last > kLargest || *last - *first >= kMostFrames) {
    throw_usage_error(
        "--frames", in_quotes(text),
        fmt::format("A:B, whole numbers, A at most B, {} frames at most", kMostFrames));
  }
  return {*first, *last};
}

std::string frame_file(const std::string& file, std::uint32_t frame, const std::string& option) {
  const std::size_t end = file.find_last_of('#');
  const std::size_t slash = file.find_last_of('/');
  if (end == std::string::npos || (slash != std::string::npos && end < slash)) {
    throw_usage_error(option, in_quotes(file),
                      "a file name with # where the number of a frame goes, as out.####.exr");
  }
  std::size_t begin = end;
  while (begin > 0 && file[begin - 1] == '#') --begin;
  return file.substr(0, begin) + fmt::format("{:0{}}", frame, end + 1 - begin) +
         file.substr(end + 1);
}

}  // namespace abbe
