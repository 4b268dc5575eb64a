// The reference: a path tracer that starts from the picture's own surface points, or from lightmap texels.
PARAM_GROUP_BEGIN(reference, ReferenceParams)

PARAM_INT(samples, 256, 2, 1048576, 16, 16384, Log, Live, "samples",
          "Paths a pixel or texel gets in all, half of them for each of the two halves from which the noise floor is measured.")
PARAM_INT(direct_samples, 64, 2, 65536, 4, 1024, Log, Reset, "samples",
          "Light samples for the direct part of a pixel or texel.")
PARAM_INT(bounces, 0, 0, 16, 0, 16, Linear, Live, "bounces",
          "Indirect bounces of the full reference; 0 follows paths to their end by Russian roulette. The matched reference takes "
          "the technique's own limit.")
PARAM_INT(seed, 1, 0, 2147483647, 0, 1000, Linear, Reset, "",
          "Seed of the reference's random sequence; independent of the picture's.")

PARAM_GROUP_END(reference, ReferenceParams)
