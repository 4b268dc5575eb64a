// The lightmap atlas: one texel holds the irradiance of one patch of surface.
PARAM_GROUP_BEGIN(lightmap, LightmapParams)

PARAM_INT(resolution, 256, 32, 4096, 64, 1024, Log, Rebuild, "texels",
          "Texels along each side of the lightmap. Memory and bake time grow with its square.")
PARAM_INT(texels, 0, 0, 16777216, 0, 1048576, Linear, Rebuild, "texels",
          "Target count of valid texels: the resolution is then chosen to come closest to it. 0 takes the resolution as it is.")
PARAM_INT(dilation, 2, 0, 8, 0, 8, Linear, Rebuild, "texels",
          "How far the values of valid texels are spread past the edges of charts, so that bilinear look-ups find no gaps at seams.")
PARAM_INT(margin, 2, 0, 16, 0, 8, Linear, Rebuild, "texels",
          "Texels kept free round each chart where the atlas is made here and not taken from the mesh.")
PARAM_FLOAT(uv_overlap_tolerance, 0.001, 0, 1, 0, 0.01, Linear, Rebuild, "share",
            "Share of covered texels that the mesh's own UV set may claim twice before charts are made here instead.")

PARAM_GROUP_END(lightmap, LightmapParams)
