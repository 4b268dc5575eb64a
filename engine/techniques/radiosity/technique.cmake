set(TECHNIQUE_SOURCES bake.cpp directions.cpp estimate.cpp host_units.cpp pick.cpp radiosity.cpp)
# Neither changes a result: loops over a packet's rays then become vector code, with selections, divisions and roots.
set_source_files_properties("${CMAKE_CURRENT_LIST_DIR}/host_units.cpp" PROPERTIES COMPILE_OPTIONS "-fno-math-errno;-fno-trapping-math")
