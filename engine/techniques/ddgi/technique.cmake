set(TECHNIQUE_SOURCES ddgi.cpp lattice.cpp pick.cpp probes.cpp)
