# The steps of the install test; each must succeed.
function(run)
  execute_process(COMMAND ${ARGN} RESULT_VARIABLE result OUTPUT_VARIABLE output
                  ERROR_VARIABLE output)
  if(NOT result EQUAL 0)
    list(JOIN ARGN " " command)
    message(FATAL_ERROR "${command}\nended with ${result}:\n${output}")
  endif()
  set(output "${output}" PARENT_SCOPE)
endfunction()

file(REMOVE_RECURSE "${work_dir}")
run(${CMAKE_COMMAND} --install ${build_dir} --prefix "${work_dir}/staging")
# An installation works wherever it is put.
file(RENAME "${work_dir}/staging" "${work_dir}/prefix")

run("${work_dir}/prefix/bin/maide" --version)
if(NOT output STREQUAL "maide ${version}\n")
  message(FATAL_ERROR "the installed program says: ${output}")
endif()

# The pages that the program names, and the examples, come along.
foreach(file docs/README.md docs/middleware/yarp.md docs/schemas/learn.json examples/case-study-1/strict-6.yaml)
  if(NOT EXISTS "${work_dir}/prefix/share/doc/maide/${file}")
    message(FATAL_ERROR "${file} is not installed")
  endif()
endforeach()

# So do manual pages, and completion for shells.
foreach(file man/man1/maide.1 man/man1/maide-check.1 bash-completion/completions/maide
             zsh/vendor-completions/_maide fish/vendor_completions.d/maide.fish)
  file(READ "${work_dir}/prefix/share/${file}" text)
  if(NOT text MATCHES "check")
    message(FATAL_ERROR "${file} does not tell of maide check")
  endif()
endforeach()

# Every wrapper that was built is installed, and the program finds it there.
file(GLOB built RELATIVE ${build_dir}/bin ${build_dir}/bin/maide-wrap-*)
execute_process(COMMAND "${work_dir}/prefix/bin/maide" doctor --json OUTPUT_VARIABLE report)
foreach(wrapper ${built})
  string(FIND "${report}" "${work_dir}/prefix/libexec/maide/${wrapper}" place)
  if(place EQUAL -1)
    message(FATAL_ERROR "${wrapper} is not installed, or not found: ${report}")
  endif()
endforeach()

run(${CMAKE_COMMAND} -S ${consumer_dir} -B "${work_dir}/consumer" -G ${generator}
    -D CMAKE_BUILD_TYPE=${build_type} -D "CMAKE_PREFIX_PATH=${work_dir}/prefix"
    -D maide_version=${version})
run(${CMAKE_COMMAND} --build "${work_dir}/consumer")
run("${work_dir}/consumer/use_maide")
run("${work_dir}/consumer/use_wrapper")
run("${work_dir}/consumer/use_learning")

# The package for Python, which finds the wrappers that were installed with it.
if(python)
  set(ENV{PYTHONPATH} "${work_dir}/prefix/${python_dir}")
  run(${python} -B -c "import maide\nprint(len(maide.learn('port').model), maide.__version__)")
  if(NOT output STREQUAL "4 ${version}\n")
    message(FATAL_ERROR "the installed package for Python says: ${output}")
  endif()
endif()

# A build without CMake.
find_program(pkg_config pkg-config REQUIRED)
file(GLOB_RECURSE pc "${work_dir}/prefix/maide.pc")
cmake_path(GET pc PARENT_PATH pc_folder)
set(ENV{PKG_CONFIG_PATH} "${pc_folder}")
run(${pkg_config} --modversion maide)
if(NOT output STREQUAL "${version}\n")
  message(FATAL_ERROR "maide.pc says: ${output}")
endif()
run(${pkg_config} --cflags --libs maide)
separate_arguments(flags UNIX_COMMAND "${output}")
run(${compiler} -std=c++20 "${consumer_dir}/use_maide.cpp" ${flags} -o "${work_dir}/by_hand")
run("${work_dir}/by_hand")
