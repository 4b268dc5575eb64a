find_package(Eigen3 REQUIRED NO_MODULE)
set(TECHNIQUE_SOURCES clusters.cpp compressor.cpp cpca.cpp directional.cpp estimate.cpp glossy.cpp memory_plan.cpp pick.cpp precomputation.cpp probe_factors.cpp probe_samples.cpp runtime.cpp srp.cpp store.cpp)
set(TECHNIQUE_DEPS Eigen3::Eigen)
