// Direct light: from emitter to surface without a bounce, the same service for pixels, lightmap texels and ray hits.
PARAM_GROUP_BEGIN(direct, DirectParams)

PARAM_INT(samples, 64, 1, 4096, 1, 1024, Log, Reset, "samples",
          "Shadow rays a pixel sends to each light in all: the running mean over frames stops there.")
PARAM_INT(samples_per_frame, 4, 1, 64, 1, 16, Log, Reset, "samples",
          "How many of them are sent in one frame. More settles in fewer, slower frames.")
PARAM_INT(lumel_samples, 64, 1, 4096, 1, 1024, Log, Reset, "samples",
          "Shadow rays a lightmap texel sends to each light.")
PARAM_FLOAT(ray_offset, 1e-5, 1e-8, 1e-2, 1e-7, 1e-3, Log, Reset, "scene diagonals",
            "How far in front of a surface its rays start. Too small and surfaces shadow themselves; too large and light leaks "
            "past contacts.")

PARAM_GROUP_END(direct, DirectParams)
