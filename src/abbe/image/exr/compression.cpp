#include "abbe/image/exr/compression.h"

#include <array>

#include "abbe/image/exr/exr.h"

namespace abbe {
namespace {

struct Named {
  const char* name;
  Imf::Compression compression;
};

constexpr std::array<Named, 10> kCompressions{{{"none", Imf::NO_COMPRESSION},
                                               {"rle", Imf::RLE_COMPRESSION},
                                               {"zips", Imf::ZIPS_COMPRESSION},
                                               {"zip", Imf::ZIP_COMPRESSION},
                                               {"piz", Imf::PIZ_COMPRESSION},
                                               {"pxr24", Imf::PXR24_COMPRESSION},
                                               {"b44", Imf::B44_COMPRESSION},
                                               {"b44a", Imf::B44A_COMPRESSION},
                                               {"dwaa", Imf::DWAA_COMPRESSION},
                                               {"dwab", Imf::DWAB_COMPRESSION}}};

}  // namespace

std::vector<std::string> exr_compressions() {
  std::vector<std::string> names;
  for (const Named& known : kCompressions) names.emplace_back(known.name);
  return names;
}

Imf::Compression exr_compression(const std::string& name) {
  for (const Named& known : kCompressions) {
    if (name == known.name) return known.compression;
  }
  return Imf::ZIP_COMPRESSION;
}

std::string exr_compression_name(Imf::Compression compression) {
  for (const Named& known : kCompressions) {
    if (compression == known.compression) return known.name;
  }
  return "unknown";
}

}  // namespace abbe
