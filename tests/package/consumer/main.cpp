#include <cstdio>

#include "abbe/session/picture.h"

int main(int, char** argv) {
  abbe::Notes notes;
  const auto standards = abbe::read_standards();
  const auto scene = abbe::prepare_scene({.file = argv[1]}, standards.catalogue, notes);
  abbe::RenderSettings settings;
  settings.size = {160, 90};
  settings.crop = abbe::PixelRect{60, 20, 100, 70};
  settings.bands = abbe::parse_bands("400:700:20");
  const abbe::Image image = abbe::render_picture(scene, settings, standards, notes).image;
  for (std::size_t c = 0; c < image.channel_count(); ++c) {  // R, G, B, then the bands.
    std::printf("%-20s %g\n", image.channels[c].c_str(), image.at(20, 25, c));
  }
  abbe::write_exr(argv[2], image, {});
}
