// Where probes stand, for every technique that has some: engine/placement.
PARAM_ENUM_BEGIN(ProbePlacement)
PARAM_ENUM_VALUE(kPlacementManual, 0, "manual", "Those of the scene's file, or of the preset where they were moved by hand.")
PARAM_ENUM_VALUE(kPlacementGrid, 1, "grid", "In the middle of the cells of a regular grid over the scene's bounds.")
PARAM_ENUM_VALUE(kPlacementVoxelGreedy, 2, "voxel_greedy",
                 "In empty voxels next to surfaces, as few as see all others of these within the merge radius (Silvennoinen and Lehtinen 2017).")
PARAM_ENUM_END(ProbePlacement)

PARAM_GROUP_BEGIN(probes, ProbesParams)

PARAM_ENUM(placement, ProbePlacement, kPlacementGrid, Rebuild, "How probes are placed. None but a manual one is ever left inside geometry.")
PARAM_FLOAT(spacing, 0.2, 0.01, 1, 0.03, 0.5, Log, Rebuild, "of the longest side",
            "grid: distance between probes, as a share of the longest side of the scene's bounds.")
PARAM_INT(count_x, 0, 0, 256, 0, 64, Linear, Rebuild, "probes", "grid: probes along x in place of the spacing. 0: as the spacing has it.")
PARAM_INT(count_y, 0, 0, 256, 0, 64, Linear, Rebuild, "probes", "grid: probes along y in place of the spacing. 0: as the spacing has it.")
PARAM_INT(count_z, 0, 0, 256, 0, 64, Linear, Rebuild, "probes", "grid: probes along z in place of the spacing. 0: as the spacing has it.")
PARAM_FLOAT(voxel, 0.05, 0.002, 0.5, 0.01, 0.2, Log, Rebuild, "of the longest side", "voxel_greedy: side of a voxel. Gaps narrower than about two are not found.")
PARAM_FLOAT(merge_radius, 0.2, 0, 2, 0.05, 0.5, Linear, Rebuild, "of the longest side",
            "voxel_greedy: a probe stands for all voxels within this distance that it sees. Larger means fewer probes.")
PARAM_FLOAT(surface_distance, 0.01, 0, 0.25, 0, 0.1, Linear, Rebuild, "of the longest side",
            "How far from surfaces a placed probe stands at least. One that is nearer is moved away, and left out where that does not help.")
PARAM_FLOAT(inside_threshold, 0.25, 0.01, 1, 0.05, 1, Linear, Rebuild, "share",
            "A place that sees this share of one-sided back faces in all directions is inside geometry.")
PARAM_INT(coverage_samples, 4096, 16, 1048576, 256, 65536, Log, Rebuild, "samples",
          "Points spread evenly over all surfaces by which coverage is measured: the share of them that some probe sees.")

PARAM_GROUP_END(probes, ProbesParams)
