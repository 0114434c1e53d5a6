# What `cmake --install` puts where. find_package(maide) gives maide::maide and all below it. With
# COMPONENTS wrapper it gives maide::wrapper, with COMPONENTS learning maide::learning, and asks for
# fewer packages.
include(CMakePackageConfigHelpers)

set(config_dir ${CMAKE_INSTALL_LIBDIR}/cmake/maide)
install(TARGETS maide_base maide_wrapper EXPORT maideWrapperTargets)
install(TARGETS maide_learning EXPORT maideLearningTargets)
install(TARGETS maide_checking maide EXPORT maideTargets)
install(TARGETS maide_program)
install(FILES ${PROJECT_SOURCE_DIR}/README.md ${PROJECT_SOURCE_DIR}/LICENSE
              ${PROJECT_SOURCE_DIR}/CHANGELOG.md ${PROJECT_SOURCE_DIR}/CITATION.cff
              ${PROJECT_SOURCE_DIR}/SECURITY.md
        DESTINATION ${CMAKE_INSTALL_DOCDIR})
# The pages link to one another, and to the examples, as in the source tree.
install(DIRECTORY ${PROJECT_SOURCE_DIR}/docs ${PROJECT_SOURCE_DIR}/examples
        DESTINATION ${CMAKE_INSTALL_DOCDIR}
        PATTERN maide-models EXCLUDE PATTERN __pycache__ EXCLUDE)
foreach(targets maideWrapperTargets maideLearningTargets maideTargets)
  install(EXPORT ${targets} NAMESPACE maide:: DESTINATION ${config_dir})
endforeach()
configure_package_config_file(maideConfig.cmake.in ${PROJECT_BINARY_DIR}/maideConfig.cmake
  INSTALL_DESTINATION ${config_dir} NO_SET_AND_CHECK_MACRO)
# Before 1.0 a minor version may change the interface.
write_basic_package_version_file(${PROJECT_BINARY_DIR}/maideConfigVersion.cmake
  COMPATIBILITY SameMinorVersion)
install(FILES ${PROJECT_BINARY_DIR}/maideConfig.cmake ${PROJECT_BINARY_DIR}/maideConfigVersion.cmake
  DESTINATION ${config_dir})

# For builds without CMake: `pkg-config --cflags --libs maide`.
file(RELATIVE_PATH pc_to_prefix /prefix/${CMAKE_INSTALL_LIBDIR}/pkgconfig /prefix)
configure_file(maide.pc.in ${PROJECT_BINARY_DIR}/maide.pc @ONLY)
install(FILES ${PROJECT_BINARY_DIR}/maide.pc DESTINATION ${CMAKE_INSTALL_LIBDIR}/pkgconfig)

# What calls of libraries mean, for `maide extract`.
install(DIRECTORY ${PROJECT_SOURCE_DIR}/share/maide DESTINATION ${CMAKE_INSTALL_DATADIR})

# Manual pages, and completion for shells: the program makes them.
if(NOT CMAKE_CROSSCOMPILING)
  install(CODE "
    set(shared \"\$ENV{DESTDIR}\${CMAKE_INSTALL_PREFIX}/${CMAKE_INSTALL_DATADIR}\")
    set(pages \"\$ENV{DESTDIR}\${CMAKE_INSTALL_PREFIX}/${CMAKE_INSTALL_MANDIR}/man1\")
    file(MAKE_DIRECTORY \"\${pages}\")
    execute_process(COMMAND \"$<TARGET_FILE:maide_program>\" manual --all -o \"\${pages}\"
                    COMMAND_ERROR_IS_FATAL ANY)
    foreach(place bash-completion/completions/maide zsh/vendor-completions/_maide
                  fish/vendor_completions.d/maide.fish)
      string(REGEX MATCH \"^[a-z]*\" shell \"\${place}\")
      get_filename_component(folder \"\${shared}/\${place}\" DIRECTORY)
      file(MAKE_DIRECTORY \"\${folder}\")
      execute_process(COMMAND \"$<TARGET_FILE:maide_program>\" completion \${shell}
                      OUTPUT_FILE \"\${shared}/\${place}\" COMMAND_ERROR_IS_FATAL ANY)
    endforeach()
  ")
endif()
