// Surfel global illumination (Ekberg 2022, chapters 3 and 4; Brinck et al. 2021, GIBS). "The thesis" is Ekberg's.
PARAM_ENUM_BEGIN(SurfelSizing)
PARAM_ENUM_VALUE(kSizingScreen, 0, "screen", "Radius of radius_pixels on screen, at most radius_max in the world.")
PARAM_ENUM_VALUE(kSizingWorld, 1, "world", "The same radius everywhere (the thesis).")
PARAM_ENUM_END(SurfelSizing)

PARAM_ENUM_BEGIN(SurfelEstimator)
PARAM_ENUM_VALUE(kEstimatorMultiScale, 0, "multi_scale",
                 "A long mean whose window grows, pulled towards a short mean as soon as the two differ by more than noise explains.")
PARAM_ENUM_VALUE(kEstimatorEma, 1, "ema", "Exponential average with a fixed hysteresis.")
PARAM_ENUM_VALUE(kEstimatorMean, 2, "mean", "As multi_scale until freeze_frames; from then on every sample counts as much as the next. Needs freeze_frames.")
PARAM_ENUM_END(SurfelEstimator)

PARAM_ENUM_BEGIN(SurfelGather)
PARAM_ENUM_VALUE(kGatherPerPixel, 0, "per_pixel", "Every pixel reads the surfels of its cell (the thesis).")
PARAM_ENUM_VALUE(kGatherHalfResolution, 1, "half_resolution", "Every fourth pixel does; the others take what lies on their own surface among the nearest four.")
PARAM_ENUM_VALUE(kGatherSplat, 2, "splat", "Surfels are drawn like deferred lights: each into the lists of the 8x8 tiles of the screen that it may light, and pixels read their tile's.")
PARAM_ENUM_END(SurfelGather)

PARAM_ENUM_BEGIN(SurfelGridKind)
PARAM_ENUM_VALUE(kGridUniform, 0, "uniform", "Cells of radius_max over the scene's bounds (the thesis).")
PARAM_ENUM_VALUE(kGridCamera, 1, "camera", "Uniform cells round the camera, and beyond them cells that grow with the distance, as surfels of constant size on screen do.")
PARAM_ENUM_END(SurfelGridKind)

PARAM_GROUP_BEGIN(surfels, SurfelsParams)

PARAM_INT(max_surfels, 65536, 1024, 1048576, 1024, 262144, Log, Rebuild, "surfels", "Memory is set aside for so many. When all are taken, no more are placed, and that is counted.")
PARAM_ENUM(sizing, SurfelSizing, kSizingScreen, Rebuild, "What the radius of a surfel follows.")
PARAM_FLOAT(radius_pixels, 8, 1, 256, 2, 64, Log, Reset, "pixels", "Radius on screen, where sizing is screen. Smaller ones resolve more and need more rays.")
PARAM_FLOAT(radius, 0.01, 1e-4, 0.25, 1e-3, 0.1, Log, Rebuild, "of diagonal", "Radius where sizing is world.")
PARAM_FLOAT(radius_max, 0.02, 1e-3, 0.25, 5e-3, 0.1, Log, Rebuild, "of diagonal",
            "Largest radius where sizing is screen, and the edge of the grid's cells.")
PARAM_FLOAT(normal_squash, 4, 1, 64, 1, 16, Log, Reset, "times",
            "How much more a distance along a surfel's normal counts than one across it (Mahalanobis metric).")
PARAM_FLOAT(coverage, 1, 0.05, 4, 0.25, 2, Log, Live, "weight", "A tile's least covered pixel gets a surfel when the surfels there weigh less than this.")
PARAM_INT(place_every, 8, 1, 1024, 1, 64, Log, Live, "frames",
          "While nothing moves, surfels are placed and removed in one of so many frames, and only then cells are listed anew; in every frame as long as many tiles or hits lack surfels. 1: always (the thesis).")
PARAM_FLOAT(place_chance, 1, 0, 1, 0.02, 1, Linear, Live, "probability", "Whether a tile that wants a surfel gets it in this frame (0.08 in the thesis).")
PARAM_BOOL(chance_by_size, false, Live, "Lowers the chance where a surfel is larger on screen than a tile, so that neighbouring tiles do not place it twice.")
PARAM_BOOL(claim_places, true, Live, "At most one new surfel a frame in a cube of about its diameter, so that tiles and rays do not place the same one twice. Off in the thesis.")
PARAM_BOOL(fill_gaps, true, Live, "Where no surfel reaches, those of the grid's cell stand in until one does, whatever their distance. Off in the thesis: black.")
PARAM_BOOL(spawn_at_hits, true, Live,
           "A ray that hits a surface without a surfel near may place one, also where the camera never looked. Off in the thesis: bounces from unseen surfaces are then lost.")
PARAM_FLOAT(hit_coverage, 0.05, 0.001, 2, 0.01, 1, Log, Live, "weight", "A hit counts as having no surfel near when the surfels there weigh less than this.")
PARAM_FLOAT(hit_reach, 2, 1, 4, 1, 4, Linear, Rebuild, "radii",
            "How far a surfel out of view lights where rays land, at most the largest radius. What no pixel sees takes as many fewer surfels as its square, and later bounces are coarser. 1 in the thesis.")
PARAM_ENUM(grid, SurfelGridKind, kGridCamera, Rebuild, "Cells by which surfels near a point are found.")
PARAM_INT(cell_limit, 512, 8, 4096, 16, 1024, Log, Live, "surfels", "A look-up reads at most so many surfels of its cell: those with the lowest numbers, in every frame the same. Cells beyond it are counted.")
PARAM_FLOAT(ray_budget, 1, 0, 64, 0.25, 16, Log, Live, "rays a surfel", "Rays a frame, on average over all surfels. 0 casts none.")
PARAM_BOOL(budget_in_view, false, Live, "ray_budget counts surfels in view whole and hidden ones by hidden_share, so that surfels left behind by a moving camera cost little. Off in the thesis: all count whole.")
PARAM_FLOAT(rays_min, 0.25, 0, 8, 0, 1, Linear, Live, "rays", "Least a surfel gets a frame, on average over frames.")
PARAM_INT(rays_max, 16, 1, 256, 1, 64, Log, Live, "rays", "Most a surfel gets in a frame.")
PARAM_FLOAT(hidden_share, 0.5, 0.01, 1, 0.05, 1, Log, Live, "share", "Rays of a surfel that no pixel has seen for a while, against those of one in view.")
PARAM_FLOAT(inconsistency_gain, 2, 0, 64, 0, 16, Linear, Live, "times", "How much inconsistency (short mean against long mean, in deviations) adds to a surfel's rays.")
PARAM_FLOAT(young_rays, 16, 0, 256, 0, 64, Linear, Live, "rays",
            "Rays beyond ray_budget for a surfel in view at its first sample, fewer with each: n / (n + samples) of them, n being window_growth at first. What a moving camera finds is soon as quiet as what it has seen for long. Off in the thesis.")
PARAM_ENUM(estimator, SurfelEstimator, kEstimatorMultiScale, Rebuild, "How rays become an estimate.")
PARAM_FLOAT(hysteresis, 0.97, 0, 0.9999, 0.8, 0.999, Linear, Live, "share", "What ema keeps of its estimate in a frame.")
PARAM_FLOAT(short_blend, 0.08, 0.001, 1, 0.01, 0.5, Log, Live, "share", "Share of a new sample in the short mean; half of it in the variance.")
PARAM_FLOAT(window_growth, 12, 0, 256, 1, 64, Linear, Live, "parts",
            "The long mean reaches back over the latest of so many parts of the cache's life at first, so that early samples without all bounces are forgotten; a surfel younger than that keeps all. 0: min_blend alone (the thesis).")
PARAM_FLOAT(window_settle, 1024, 1, 1e6, 16, 4096, Log, Live, "samples", "After so many samples the number of parts has halved; it falls to 2.")
PARAM_FLOAT(min_blend, 0.00048828125, 1e-6, 1, 1e-4, 0.1, Log, Live, "share", "Least share of a new sample in the long mean (1/256 in the thesis).")
PARAM_FLOAT(change_samples, 16, 0, 65536, 0, 256, Linear, Live, "samples",
            "When lights are edited or animated, an estimate counts as no more samples than this, and so follows at once. 0: it has to find out by itself.")
PARAM_FLOAT(firefly_limit, 0, 0, 64, 0, 16, Linear, Live, "deviations",
            "Cuts samples so many deviations above the short mean (8 in Barre-Brisebois et al. 2019), which makes the result darker; counted. 0: off.")
PARAM_FLOAT(seed_samples, 4, 0, 256, 0, 32, Linear, Live, "samples", "So many samples (frames with rays) the neighbours' light counts as in a new surfel. 0: it starts without.")
PARAM_FLOAT(fade_in, 8, 0, 256, 0, 64, Linear, Live, "samples", "A surfel with so many samples has half its weight. 0: whole from the first on.")
PARAM_ENUM(gather, SurfelGather, kGatherPerPixel, Live, "How pixels read surfels.")
PARAM_BOOL(depth_test, true, Reset, "Surfels remember how far they see in 4x4 directions, and light no point that something hides from them (Chebyshev's inequality). Off in the thesis.")
PARAM_FLOAT(depth_softness, 0.05, 1e-4, 1, 0.01, 0.5, Log, Live, "radii", "Least deviation of a remembered distance.")
PARAM_BOOL(guiding, false, Reset, "Rays go where light came from: a 6x6 map a surfel, weights exact. Off in the thesis.")
PARAM_FLOAT(guide_uniform, 0.3, 0.01, 1, 0.05, 1, Linear, Live, "share", "Share of the rays that guiding leaves uniform, so that no direction is forgotten.")
PARAM_BOOL(recycle, true, Live, "Removes surfels that nothing has looked at for a while when memory runs low, and those that others cover. Off in the thesis.")
PARAM_FLOAT(recycle_fill, 0.75, 0, 1, 0.25, 1, Linear, Live, "of max_surfels", "From so many surfels on unseen ones are removed, the farther the sooner.")
PARAM_INT(recycle_frames, 120, 1, 100000, 10, 1000, Log, Live, "frames", "Neither pixel nor ray has looked at a surfel for so long: it counts as unseen.")
PARAM_FLOAT(recycle_coverage, 3, 0.5, 64, 2, 16, Log, Live, "weight", "A surfel that all others together cover by more than this may be removed.")
PARAM_FLOAT(recycle_hidden, 0.5, 0.01, 64, 0.1, 16, Log, Live, "weight",
            "The same for one that no pixel needs now. Rays place them where less than hit_coverage is, so dense ones left behind by a moving camera would be more than they need.")
PARAM_FLOAT(recycle_chance, 0.05, 0, 1, 0.001, 0.2, Linear, Live, "probability", "Whether one that may be removed is, in this frame: if all went at once, a hole would be left.")
PARAM_INT(freeze_frames, 0, 0, 100000, 0, 4096, Linear, Rebuild, "frames", "So many frames after a reset the cache freezes: no surfel is placed or removed any more. 0: never.")
PARAM_INT(settle_frames, 256, 1, 100000, 16, 4096, Log, Live, "frames", "From so many frames on in which nothing moved and no light changed, the picture counts as settled.")
PARAM_INT(settled_every, 4, 1, 64, 1, 16, Log, Live, "frames",
          "Once settled, rays are cast in one of so many frames and pixels gather in another, and what noise is left falls as much slower. Whatever changes ends it at once. Not with ema, which counts frames, nor in a cache that is frozen. 1: in every frame (the thesis).")
PARAM_INT(settled_place_every, 64, 1, 4096, 8, 256, Log, Live, "frames", "place_every once settled, where it is more. 1: place_every (the thesis).")

PARAM_GROUP_END(surfels, SurfelsParams)
