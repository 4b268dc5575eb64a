// Radiosity on a lightmap (Kahl 2023, chapters 4 and 5).
PARAM_ENUM_BEGIN(RadiosityEstimator)
PARAM_ENUM_VALUE(kEstimatorDirectional, 0, "directional",
                 "Rays from each texel over its hemisphere, cosine distributed; each brings back the radiosity of the texel it hits.")
PARAM_ENUM_END(RadiosityEstimator)

PARAM_ENUM_BEGIN(RadiosityDirections)
PARAM_ENUM_VALUE(kDirectionsLowDiscrepancy, 0, "low_discrepancy",
                 "A lattice of the unit square, shifted for each texel, laid on the hemisphere by the concentric map.")
PARAM_ENUM_VALUE(kDirectionsLargestEmptyCircle, 1, "largest_empty_circle",
                 "Each direction in the middle of the largest empty circle of the disc (Laine 2007), turned for each texel.")
PARAM_ENUM_END(RadiosityDirections)

PARAM_ENUM_BEGIN(RadiositySolver)
PARAM_ENUM_VALUE(kSolverJacobi, 0, "jacobi", "One bounce a pass: every texel gathers what the last pass left.")
PARAM_ENUM_END(RadiositySolver)

PARAM_ENUM_BEGIN(RadiosityLookup)
PARAM_ENUM_VALUE(kLookupBilinear, 0, "bilinear", "Between the four nearest texels of the surface's own chart.")
PARAM_ENUM_VALUE(kLookupNearest, 1, "nearest", "The texel itself: shows the patches as they were computed.")
PARAM_ENUM_END(RadiosityLookup)

PARAM_GROUP_BEGIN(radiosity, RadiosityParams)

PARAM_ENUM(estimator, RadiosityEstimator, kEstimatorDirectional, Rebuild, "How a texel finds the light that reaches it.")
PARAM_ENUM(solver, RadiositySolver, kSolverJacobi, Reset, "How bounce follows bounce.")
PARAM_INT(samples, 1024, 1, 4096, 16, 4096, Log, Rebuild, "rays",
          "Rays a texel casts. Noise falls with their number, bake time and the hit cache grow with it.")
PARAM_ENUM(directions, RadiosityDirections, kDirectionsLowDiscrepancy, Rebuild, "The set of directions that every texel casts.")
PARAM_BOOL(unweighted, false, Rebuild,
           "Leaves out what makes the largest_empty_circle set uniform, as the thesis does: its rim counts too much.")
PARAM_INT(bounces, 8, 1, 64, 1, 64, Log, Reset, "bounces", "Bounces at most.")
PARAM_FLOAT(residual, 1e-3, 0, 1, 1e-6, 0.1, Log, Reset, "share",
            "Bounces stop early when one changes the light by less than this share of it. 0 takes them all.")
PARAM_ENUM(lookup, RadiosityLookup, kLookupBilinear, Live, "How pixels read the lightmap.")
PARAM_INT(slice_ms, 30, 1, 1000, 5, 200, Log, Live, "ms",
          "Work done between two frames. Changes how long a frame waits, never the result.")
PARAM_INT(hit_cache_mb, 512, 0, 16384, 0, 4096, Linear, Rebuild, "MiB",
          "Memory that remembers which texel each ray hit (4 bytes a ray), so that later bounces and changed lights need no rays. "
          "Texels beyond it cast theirs again. 0 remembers none. Never changes the result.")

PARAM_GROUP_END(radiosity, RadiosityParams)
