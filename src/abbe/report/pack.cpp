#include "abbe/report/pack.h"

#include <zlib.h>

#include <algorithm>
#include <cmath>
#include <cstring>

#include "abbe/base/error.h"
#include "abbe/base/file.h"

namespace abbe {
namespace {

// x86-64 is little endian; so are the pages' readers.
void append_bytes(float value, std::vector<std::uint8_t>& out) {
  std::uint8_t bytes[sizeof(float)];
  std::memcpy(bytes, &value, sizeof(float));
  out.insert(out.end(), std::begin(bytes), std::end(bytes));
}

}  // namespace

std::string base64(std::span<const std::uint8_t> bytes) {
  constexpr const char* kDigits =
      "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
  std::string text;
  text.reserve((bytes.size() + 2) / 3 * 4);
  for (std::size_t i = 0; i < bytes.size(); i += 3) {
    const std::size_t count = std::min<std::size_t>(3, bytes.size() - i);
    std::uint32_t word = 0;
    for (std::size_t k = 0; k < 3; ++k) word = word << 8 | (k < count ? bytes[i + k] : 0u);
    for (std::size_t k = 0; k < 4; ++k) {
      text += k <= count ? kDigits[word >> (18 - 6 * k) & 63u] : '=';
    }
  }
  return text;
}

std::string data_uri(const std::filesystem::path& file, const std::string& media_type) {
  constexpr std::uint64_t kMaxBytes = std::uint64_t{1} << 30;
  return "data:" + media_type + ";base64," + base64(read_file(file, file.string(), kMaxBytes));
}

std::string deflated_base64(std::span<const std::uint8_t> bytes) {
  uLongf size = compressBound(static_cast<uLong>(bytes.size()));
  std::vector<std::uint8_t> out(size);
  if (compress2(out.data(), &size, bytes.data(), static_cast<uLong>(bytes.size()), 6) != Z_OK) {
    throw_output_error("", "data that could not be compressed", "memory for it");
  }
  out.resize(size);
  return base64(out);
}

Blocks block_means(std::span<const float> pixels, int width, int height, std::size_t channels,
                   int block) {
  Blocks blocks;
  blocks.width = (width + block - 1) / block;
  blocks.height = (height + block - 1) / block;
  blocks.values.resize(static_cast<std::size_t>(blocks.width) * blocks.height * channels, 0.0f);
  for (int by = 0; by < blocks.height; ++by) {
    for (int bx = 0; bx < blocks.width; ++bx) {
      const int x1 = std::min(width, (bx + 1) * block), y1 = std::min(height, (by + 1) * block);
      float* out =
          blocks.values.data() + (static_cast<std::size_t>(by) * blocks.width + bx) * channels;
      const auto share = 1.0f / static_cast<float>((x1 - bx * block) * (y1 - by * block));
      for (int y = by * block; y < y1; ++y) {
        for (int x = bx * block; x < x1; ++x) {
          const float* in = pixels.data() + (static_cast<std::size_t>(y) * width + x) * channels;
          for (std::size_t c = 0; c < channels; ++c) {
            if (std::isfinite(in[c])) out[c] += share * in[c];
          }
        }
      }
    }
  }
  return blocks;
}

PackedMap packed_map(const std::vector<float>& map, int width, int height, int block) {
  const Blocks blocks = block_means(map, width, height, 1, block);
  PackedMap packed;
  packed.width = blocks.width;
  packed.height = blocks.height;
  for (const float value : blocks.values) {
    packed.max = std::max(packed.max, std::abs(static_cast<double>(value)));
    packed.is_signed = packed.is_signed || value < 0.0f;
  }
  std::vector<std::uint8_t> bytes;
  bytes.reserve(blocks.values.size());
  const double codes = packed.is_signed ? 127.0 : 255.0;
  int left = 0;
  for (std::size_t i = 0; i < blocks.values.size(); ++i) {
    if (i % static_cast<std::size_t>(blocks.width) == 0) left = 0;
    const auto value = static_cast<double>(blocks.values[i]);
    const double root = packed.max > 0.0 ? std::sqrt(std::abs(value) / packed.max) : 0.0;
    const int code = static_cast<int>(std::lround(codes * root)) * (value < 0.0 ? -1 : 1);
    bytes.push_back(static_cast<std::uint8_t>((code - left) & 255));
    left = code;
  }
  packed.data = deflated_base64(bytes);
  return packed;
}

std::string packed_spectra(const Blocks& blocks, std::size_t bands) {
  std::vector<std::uint8_t> bytes;
  const std::size_t count = bands > 0 ? blocks.values.size() / bands : 0;
  const auto largest_of = [&](std::size_t i) {
    float largest = 0.0f;
    for (std::size_t b = 0; b < bands; ++b)
      largest = std::max(largest, blocks.values[i * bands + b]);
    return largest;
  };
  for (std::size_t i = 0; i < count; ++i) append_bytes(largest_of(i), bytes);
  for (std::size_t i = 0; i < count; ++i) {
    const float largest = largest_of(i);
    for (std::size_t b = 0; b < bands; ++b) {
      const float share = largest > 0.0f ? blocks.values[i * bands + b] / largest : 0.0f;
      bytes.push_back(
          static_cast<std::uint8_t>(std::lround(255.0f * std::clamp(share, 0.0f, 1.0f))));
    }
  }
  return deflated_base64(bytes);
}

PackedNumbers packed_numbers(std::span<const float> values) {
  PackedNumbers packed;
  for (const float value : values) {
    packed.max = std::max(packed.max, std::abs(static_cast<double>(value)));
  }
  std::vector<std::uint8_t> bytes;
  bytes.reserve(values.size() * 2);
  for (const float value : values) {
    const double root =
        packed.max > 0.0 ? std::sqrt(std::abs(static_cast<double>(value)) / packed.max) : 0.0;
    const auto code =
        static_cast<unsigned>(std::lround(32767.0 * root) * (value < 0.0f ? -1 : 1)) & 0xffffu;
    bytes.push_back(static_cast<std::uint8_t>(code & 255u));
    bytes.push_back(static_cast<std::uint8_t>(code >> 8));
  }
  packed.data = deflated_base64(bytes);
  return packed;
}

}  // namespace abbe
