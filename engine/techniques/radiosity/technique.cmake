set(TECHNIQUE_SOURCES bake.cpp directions.cpp lightmap_tables.cpp pick.cpp radiosity.cpp)
