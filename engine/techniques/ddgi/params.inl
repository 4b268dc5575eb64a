// Dynamic diffuse global illumination by a grid of irradiance probes (Majercik et al. 2019, 2021; Ekberg 2022, chapter 3.2).
PARAM_ENUM_BEGIN(DdgiStart)
PARAM_ENUM_VALUE(kStartBounces, 0, "bounces",
                 "First as many frames without history as bounces are worth following at the scene's mean albedo, then a mean over frames until the "
                 "hysteresis takes over.")
PARAM_ENUM_VALUE(kStartEma, 1, "ema", "From black, with the hysteresis from the first frame on: in a furnace x (1 - f^n), f = 1 - (1 - a) (1 - rho).")
PARAM_ENUM_END(DdgiStart)

PARAM_ENUM_BEGIN(DdgiRotation)
PARAM_ENUM_VALUE(kRotationPerFrame, 0, "per_frame", "All probes turn their rays alike (the source): neighbours err together.")
PARAM_ENUM_VALUE(kRotationPerProbe, 1, "per_probe", "Each probe turns its own: errors of neighbours cancel in part.")
PARAM_ENUM_END(DdgiRotation)

PARAM_ENUM_BEGIN(DdgiMoments)
PARAM_ENUM_VALUE(kMomentsReciprocal, 0, "reciprocal",
                 "Of reciprocal distances: what lies far beyond a wall's edge weighs little, and walls seen at a slant stay closed.")
PARAM_ENUM_VALUE(kMomentsPlain, 1, "plain", "Of distances (the source).")
PARAM_ENUM_END(DdgiMoments)

PARAM_GROUP_BEGIN(ddgi, DdgiParams)

PARAM_FLOAT(spacing, 0.125, 0.01, 1, 0.03, 0.5, Log, Rebuild, "of the longest side",
            "Distance between probes, as a share of the longest side of the scene's surfaces.")
PARAM_INT(count_x, 0, 0, 256, 0, 64, Linear, Rebuild, "probes", "Probes along x in place of the spacing. 0: as the spacing has it.")
PARAM_INT(count_y, 0, 0, 256, 0, 64, Linear, Rebuild, "probes", "Probes along y in place of the spacing. 0: as the spacing has it.")
PARAM_INT(count_z, 0, 0, 256, 0, 64, Linear, Rebuild, "probes", "Probes along z in place of the spacing. 0: as the spacing has it.")
PARAM_FLOAT(inset, 0.1, 0, 0.5, 0, 0.5, Linear, Rebuild, "spacings",
            "How far inside the bounds of all surfaces the outermost probes lie. 0: in the enclosing walls, and relocation must free them.")
PARAM_INT(rays, 256, 16, 1024, 16, 1024, Log, Reset, "rays", "Rays a probe casts in a frame.")
PARAM_ENUM(rotation, DdgiRotation, kRotationPerProbe, Reset, "How rays are turned at random from frame to frame.")
PARAM_FLOAT(hysteresis, 0.97, 0, 0.999, 0.5, 0.999, Linear, Reset, "share", "Weight of what a probe knew against what a frame's rays say.")
PARAM_ENUM(start, DdgiStart, kStartBounces, Reset, "How probes begin after a reset.")
PARAM_FLOAT(change_threshold, 0, 0, 1, 0, 1, Linear, Reset, "share",
            "Where a texel's luminance differs by more than this share of the larger value, history counts for a quarter. Faster after changes, biased "
            "where rays are few. 0: off.")
PARAM_FLOAT(gamma, 1, 1, 8, 1, 8, Linear, Reset, "exponent",
            "Irradiance is averaged as its 1/gamma-th power. 5 is usual, converges faster to the eye, and is biased dark.")
PARAM_INT(irradiance_texels, 6, 2, 28, 4, 16, Linear, Rebuild, "texels", "Side of a probe's octahedral map of irradiance, without its border.")
PARAM_INT(distance_texels, 14, 4, 28, 6, 28, Linear, Rebuild, "texels", "Side of a probe's octahedral map of distances, without its border.")
PARAM_FLOAT(distance_exponent, 50, 1, 200, 5, 100, Log, Reset, "exponent", "Sharpness of the cosine lobe over which a texel averages distances.")
PARAM_FLOAT(normal_bias, 0.1, 0, 1, 0, 0.5, Linear, Reset, "spacings", "How far points move along their normal before they ask probes.")
PARAM_FLOAT(view_bias, 0.2, 0, 1, 0, 0.5, Linear, Reset, "spacings", "How far points move towards the viewer, or the ray's origin, before they ask probes.")
PARAM_BOOL(visibility, true, Reset, "Weighs a probe by the chance that it sees the point (Chebyshev's inequality on its map of distances).")
PARAM_ENUM(visibility_moments, DdgiMoments, kMomentsReciprocal, Reset, "What the maps of distance hold the mean and the mean square of.")
PARAM_FLOAT(visibility_power, 6, 1, 16, 1, 10, Linear, Reset, "exponent",
            "Of Chebyshev's bound. 3 is usual; more lets less through walls that a probe stands close behind.")
PARAM_FLOAT(visibility_floor, 0, 0, 1, 0, 0.2, Linear, Reset, "share",
            "What visibility leaves of a weight at least. 0.05 is usual, and what leaks through walls.")
PARAM_BOOL(facing, true, Reset, "Weighs a probe by where it lies: less behind the surface than before it.")
PARAM_BOOL(crush, true, Reset, "Weights below a fifth fall off faster, so that many little ones do not add up.")
PARAM_BOOL(multi_bounce, true, Reset, "What rays hit reflects the probes' own light of the last frame too; else one bounce alone.")
PARAM_BOOL(relocation, true, Rebuild, "Moves probes out of geometry and away from surfaces.")
PARAM_FLOAT(relocation_distance, 0.1, 0, 0.5, 0, 0.5, Linear, Rebuild, "spacings", "How far from surfaces relocation wants a probe.")
PARAM_FLOAT(relocation_limit, 0.4, 0, 0.45, 0, 0.45, Linear, Rebuild, "spacings", "How far along each axis relocation moves a probe at most.")
PARAM_BOOL(classification, true, Rebuild, "Probes inside geometry, and those with no surface in any cell round them, cast no rays and are left out.")
PARAM_FLOAT(inside_threshold, 0.25, 0.01, 1, 0.05, 1, Linear, Rebuild, "share", "A probe that sees this share of one-sided back faces is inside geometry.")

PARAM_GROUP_END(ddgi, DdgiParams)
