# Targets `format` (rewrites) and `format-check` (fails on the first difference), with the version that .clang-format is written for.
find_program(CLANG_FORMAT clang-format-14)
if(CLANG_FORMAT)
  set(list_sources "git -C '${CMAKE_SOURCE_DIR}' ls-files -z '*.cpp' '*.h'")
  set(run_format "cd '${CMAKE_SOURCE_DIR}' && xargs -0 '${CLANG_FORMAT}'")
  add_custom_target(format COMMAND bash -c "${list_sources} | (${run_format} -i)" VERBATIM)
  add_custom_target(format-check COMMAND bash -c "set -o pipefail; ${list_sources} | (${run_format} --dry-run -Werror)" VERBATIM)
endif()
