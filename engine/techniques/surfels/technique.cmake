set(TECHNIQUE_SOURCES cache.cpp grid.cpp passes.cpp pick.cpp prefix_sum.cpp surfels.cpp)
