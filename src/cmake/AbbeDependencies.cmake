# Every library that the modules of src/ stand on: what the build looks for, and what the installed
# package looks for again.
set(ABBE_DEPENDENCIES
  glm
  hwy
  TBB
  fmt
  nlohmann_json
  ZLIB
  PNG
  OpenEXR
  TinyGLTF
  yaml-cpp
  CLI11
  OpenColorIO)

# What only the module stands on that is loaded when first needed: programs do not link it.
set(ABBE_MODULE_DEPENDENCIES
  OpenImageIO)

# Libraries that one feature each needs, which says so where it is asked for without them.
set(ABBE_OPTIONAL_DEPENDENCIES
  draco
  meshoptimizer)
