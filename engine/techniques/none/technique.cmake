set(TECHNIQUE_SOURCES none.cpp)
