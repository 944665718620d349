# Draco's archive with its own tinygltf under another name. Debian builds Draco with a tinygltf of
# other layouts inside, whose functions the linker would take for those of libtinygltf.
# Defines the target abbe_draco, and abbe_draco_archive, where it lies.
include(GNUInstallDirs)
set(abbe_draco_archive ${PROJECT_BINARY_DIR}/libabbe_draco.a)
add_custom_command(OUTPUT ${abbe_draco_archive}
  COMMAND sh -c "\"$1\" \"$3\" 2>/dev/null | awk '/tinygltf|stbi/ { print $NF, $NF \"_of_draco\" }' | sort -u >\"$4.names\" && \"$2\" --redefine-syms=\"$4.names\" \"$3\" \"$4\""
          sh ${CMAKE_NM} ${CMAKE_OBJCOPY} $<TARGET_FILE:draco::draco_static> ${abbe_draco_archive}
  DEPENDS $<TARGET_FILE:draco::draco_static> VERBATIM)
add_custom_target(abbe_draco DEPENDS ${abbe_draco_archive})
