// Numbers as text in a page, read back as a browser would.

#include "abbe/report/pack.h"

#include <gtest/gtest.h>
#include <zlib.h>

#include <cmath>

#include "abbe/report/page.h"

namespace abbe {
namespace {

std::vector<std::uint8_t> from_base64(const std::string& text) {
  const std::string digits = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
  std::vector<std::uint8_t> bytes;
  std::uint32_t word = 0;
  int bits = 0;
  for (const char c : text) {
    if (c == '=') break;
    word = word << 6 | static_cast<std::uint32_t>(digits.find(c));
    bits += 6;
    if (bits >= 8) bytes.push_back(static_cast<std::uint8_t>(word >> (bits -= 8)));
  }
  return bytes;
}

std::vector<std::uint8_t> inflated(const std::string& text, std::size_t size) {
  const std::vector<std::uint8_t> packed = from_base64(text);
  std::vector<std::uint8_t> bytes(size);
  uLongf length = size;
  EXPECT_EQ(uncompress(bytes.data(), &length, packed.data(), packed.size()), Z_OK);
  EXPECT_EQ(length, size);
  return bytes;
}

TEST(Base64, test_vectors_of_rfc_4648) {
  const auto text = [](const std::string& plain) {
    return base64({reinterpret_cast<const std::uint8_t*>(plain.data()), plain.size()});
  };
  EXPECT_EQ(text(""), "");
  EXPECT_EQ(text("f"), "Zg==");
  EXPECT_EQ(text("fo"), "Zm8=");
  EXPECT_EQ(text("foo"), "Zm9v");
  EXPECT_EQ(text("foobar"), "Zm9vYmFy");
}

TEST(PackedMap, values_come_back_within_half_a_code) {
  const std::vector<float> map{0.0f, 0.5f, -2.0f, 8.0f, 3.0f, -0.01f};
  const PackedMap packed = packed_map(map, 3, 2, 1);
  EXPECT_TRUE(packed.is_signed);
  EXPECT_DOUBLE_EQ(packed.max, 8.0);
  const std::vector<std::uint8_t> codes = inflated(packed.data, 6);
  int left = 0;
  for (std::size_t i = 0; i < codes.size(); ++i) {
    if (i % 3 == 0) left = 0;
    left = (left + codes[i]) & 255;
    const double root = (left > 127 ? left - 256 : left) / 127.0;
    const double expected = std::copysign(std::sqrt(std::abs(map[i]) / 8.0), map[i]);
    EXPECT_NEAR(root, expected, 0.5001 / 127.0) << i;  // Half a step of rounding.
  }
}

TEST(PackedMap, blocks_are_means_also_at_the_edge) {
  const Blocks blocks = block_means(std::vector<float>{1, 3, 10, 5, 7, 20}, 3, 2, 1, 2);
  EXPECT_EQ(blocks.width, 2);
  EXPECT_EQ(blocks.height, 1);
  EXPECT_FLOAT_EQ(blocks.values[0], 4.0f);
  EXPECT_FLOAT_EQ(blocks.values[1], 15.0f);
}

TEST(PackedMap, what_is_not_finite_counts_as_nothing) {
  const PackedMap packed = packed_map({NAN, INFINITY, 1.0f}, 3, 1, 1);
  EXPECT_DOUBLE_EQ(packed.max, 1.0);
  EXPECT_EQ(inflated(packed.data, 3), (std::vector<std::uint8_t>{0, 0, 255}));
}

TEST(Page, text_of_a_scene_cannot_leave_its_element) {
  const std::string evil = "</script><b>&\"";
  const std::string page = comparison_page(evil, "\"</script><b>\"");
  EXPECT_EQ(page.find("</script><b>"), std::string::npos);
  EXPECT_NE(page.find("&lt;/script&gt;&lt;b&gt;&amp;&quot;"), std::string::npos);
}

TEST(Page, nothing_is_loaded_from_elsewhere) {
  const std::string page = comparison_page("a", "{}");
  for (const char* way : {"src=\"http", "href=\"http", "@import", "fetch(", "XMLHttpRequest"}) {
    EXPECT_EQ(page.find(way), std::string::npos) << way;
  }
}

}  // namespace
}  // namespace abbe
