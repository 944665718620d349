/// Pixels of one to four channels as R, G, B, A.
#pragma once

#include <cstddef>

namespace abbe {

/// Grey is repeated; missing alpha is `opaque`. Domain: `out` holds 4 * pixels values.
template <typename T>
void to_rgba(const T* in, std::size_t pixels, std::size_t channels, T opaque, T* out) {
  const bool is_grey = channels < 3;
  for (std::size_t p = 0; p < pixels; ++p, in += channels, out += 4) {
    out[0] = in[0];
    out[1] = in[is_grey ? 0 : 1];
    out[2] = in[is_grey ? 0 : 2];
    out[3] = channels == 4 ? in[3] : channels == 2 ? in[1] : opaque;
  }
}

}  // namespace abbe
