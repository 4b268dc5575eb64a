// A group with one parameter of each type.
PARAM_ENUM_BEGIN(ExampleMode)
PARAM_ENUM_VALUE(kExampleModeStatic, 0, "static", "The same for all.")
PARAM_ENUM_VALUE(kExampleModeMonteCarlo, 1, "monte_carlo", "Drawn anew, for each texel.")
PARAM_ENUM_VALUE(kExampleModeMipmapped, 2, "mipmapped", "From the mean of a window.")
PARAM_ENUM_END(ExampleMode)

PARAM_GROUP_BEGIN(example, ExampleParams)
PARAM_INT(samples, 1024, 1, 4096, 16, 2048, Log, Rebuild, "rays", "Rays a texel sends.")
PARAM_FLOAT(residual, 0.001, 0, 0.1, 1e-6, 0.1, Log, Reset, "", "Where it stops.")
PARAM_BOOL(clamped, false, Live, "Whether "
           "the sum is clamped.")
PARAM_ENUM(mode, ExampleMode, kExampleModeMonteCarlo, Rebuild, "How.")
PARAM_GROUP_END(example, ExampleParams)
