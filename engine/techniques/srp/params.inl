// Sparse radiance probes (Bennett 2019, chapters 4 and 5; Silvennoinen and Lehtinen 2017).
PARAM_ENUM_BEGIN(SrpSupport)
PARAM_ENUM_VALUE(kSupportProbeRadius, 0, "probe_radius", "All probes nearer than a radius that is the same everywhere (the thesis).")
PARAM_ENUM_VALUE(kSupportReceiverRadius, 1, "receiver_radius", "The nearest probes, up to a number: each receiver has a radius of its own.")
PARAM_ENUM_END(SrpSupport)

PARAM_ENUM_BEGIN(SrpCompression)
PARAM_ENUM_VALUE(kCompressionNone, 0, "none", "Every transport vector is kept as it is.")
PARAM_ENUM_VALUE(kCompressionCpca, 1, "cpca", "Clustered principal components: a few vectors a cluster, and each receiver's weights of them.")
PARAM_ENUM_END(SrpCompression)

PARAM_ENUM_BEGIN(SrpClustering)
PARAM_ENUM_VALUE(kClusteringAabb, 0, "aabb", "Boxes round receivers, halved along their longest side (the thesis).")
PARAM_ENUM_VALUE(kClusteringLbg, 1, "lbg", "Split in two by nearest means of position and normal (Linde, Buzo and Gray 1980), so that a cluster faces one way.")
PARAM_ENUM_END(SrpClustering)

PARAM_ENUM_BEGIN(SrpStorage)
PARAM_ENUM_VALUE(kStorageFloat32, 0, "float32", "4 bytes a number.")
PARAM_ENUM_VALUE(kStorageFloat16, 1, "float16", "2 bytes a number.")
PARAM_ENUM_END(SrpStorage)

PARAM_ENUM_BEGIN(SrpWindow)
PARAM_ENUM_VALUE(kWindowNone, 0, "none", "Bands as they are.")
PARAM_ENUM_VALUE(kWindowHann, 1, "hann", "Bands fade out as half a cosine.")
PARAM_ENUM_VALUE(kWindowLanczos, 2, "lanczos", "Bands fade out as a sinc.")
PARAM_ENUM_END(SrpWindow)

PARAM_ENUM_BEGIN(SrpSampleWeight)
PARAM_ENUM_VALUE(kSampleWeightValid, 0, "valid", "The mean is over samples that some probe can speak for.")
PARAM_ENUM_VALUE(kSampleWeightAll, 1, "all", "The mean is over all samples: what no probe sees counts as dark (figure 5.6, left).")
PARAM_ENUM_VALUE(kSampleWeightSurface, 2, "surface", "What no probe sees is read off the lightmap where the ray ends, surface_reads times a receiver at most.")
PARAM_ENUM_END(SrpSampleWeight)

PARAM_ENUM_BEGIN(SrpReceivers)
PARAM_ENUM_VALUE(kReceiversIrradiance, 0, "irradiance", "Irradiance for the surface's own normal: one transport vector a receiver (the thesis).")
PARAM_ENUM_VALUE(kReceiversDirectional, 1, "directional",
                 "How irradiance changes with the normal besides, for smooth normals and normal maps: four vectors a receiver, and four times the matrices.")
PARAM_ENUM_VALUE(kReceiversRadiance, 2, "radiance",
                 "Receivers on glossy surfaces also know radiance over their hemisphere, to glossy_order: their indirect light is seen reflected. Others know irradiance.")
PARAM_ENUM_END(SrpReceivers)

PARAM_ENUM_BEGIN(SrpProbeShare)
PARAM_ENUM_VALUE(kShareDistance, 0, "distance", "By the probe's distance from the receiver alone (the thesis, equation 4.4).")
PARAM_ENUM_VALUE(kShareSolidAngle, 1, "solid_angle", "By that, times the solid angle under which the probe sees what the receiver sees: bands blur it over as many square metres as that angle is small.")
PARAM_ENUM_END(SrpProbeShare)

PARAM_GROUP_BEGIN(srp, SrpParams)

PARAM_INT(sh_order, 4, 0, 8, 0, 8, Linear, Rebuild, "order",
          "Highest band of the spherical harmonics that hold a probe's radiance: (order + 1)^2 coefficients. Sharper light for more memory and time.")
PARAM_INT(receiver_rays, 1024, 16, 16384, 64, 4096, Log, Rebuild, "rays", "Rays a receiver casts once, to find what it sees. Precomputation time grows with them.")
PARAM_INT(probe_rays, 1024, 64, 16384, 64, 4096, Log, Rebuild, "rays",
          "Rays a probe casts once. What they hit is looked up in the lightmap in every frame.")
PARAM_ENUM(receivers, SrpReceivers, kReceiversIrradiance, Rebuild, "What receivers know of the light that reaches them.")
PARAM_INT(glossy_order, 4, 0, 8, 0, 8, Linear, Rebuild, "order",
          "receivers radiance: degree of the polynomials that hold radiance at a glossy receiver; (n + 1)(n + 2) / 2 vectors beside irradiance's. Sharper reflections for more memory and time.")
PARAM_INT(glossy_samples, 64, 4, 512, 16, 256, Log, Live, "directions", "receivers radiance: directions of a glossy pixel's lobe in which radiance is read.")
PARAM_ENUM(support, SrpSupport, kSupportReceiverRadius, Rebuild, "Which probes a receiver may ask.")
PARAM_FLOAT(radius, 0.25, 0.01, 4, 0.05, 1, Log, Rebuild, "of the longest side", "probe_radius: how far a probe reaches.")
PARAM_INT(k, 8, 1, 64, 1, 32, Log, Rebuild, "probes", "receiver_radius: probes a receiver asks at most.")
PARAM_ENUM(probe_share, SrpProbeShare, kShareSolidAngle, Rebuild, "How those probes that see what a receiver's ray hit share in it.")
PARAM_ENUM(compression, SrpCompression, kCompressionCpca, Rebuild, "How transport vectors are kept.")
PARAM_INT(pca_vectors, 32, 1, 128, 4, 128, Log, Rebuild, "vectors", "cpca: vectors a cluster keeps at most.")
PARAM_FLOAT(pca_tolerance, 0, 0, 1, 1e-4, 0.1, Log, Rebuild, "share",
            "cpca: a cluster keeps no more vectors than leave out this share of its transport (Frobenius norm). 0 keeps pca_vectors everywhere.")
PARAM_BOOL(pca_keep_constant, true, Rebuild,
           "cpca: weights are moved by the least that lets light which is the same everywhere pass unchanged, so that compression neither makes nor loses it bounce by bounce. The thesis leaves them.")
PARAM_ENUM(clustering, SrpClustering, kClusteringAabb, Rebuild, "Which receivers are computed and compressed together.")
PARAM_INT(cluster_size, 1024, 16, 8192, 64, 4096, Log, Rebuild, "receivers", "Receivers a cluster has at most.")
PARAM_INT(least_clusters, 32, 1, 4096, 1, 128, Log, Rebuild, "clusters",
          "Of few receivers a cluster has at most this part, but always 64: clusters that are large beside the room compress badly.")
PARAM_ENUM(storage, SrpStorage, kStorageFloat32, Rebuild, "Numbers of the matrices.")
PARAM_BOOL(multi_bounce, true, Reset, "Probes see the last frame's indirect light too: all bounces, one a frame. Off: the first alone.")
PARAM_INT(update_frames, 1, 1, 16, 1, 16, Log, Reset, "frames",
          "Frames in which all probes have been updated once: each frame takes one probe in so many (probe update fraction 1 / this).")
PARAM_ENUM(window, SrpWindow, kWindowNone, Reset, "Takes ringing out of the probes' light, and sharpness with it. The mean (band 0) stays as it is.")
PARAM_BOOL(environment_rays, true, Rebuild,
           "A receiver's ray into the open asks whether probes see that too. Off: such rays are left out, which makes open places too bright (figure 5.5).")
PARAM_ENUM(sample_weight, SrpSampleWeight, kSampleWeightSurface, Rebuild, "What becomes of a receiver's rays to places that none of its probes sees.")
PARAM_BOOL(surface_share, true, Rebuild,
           "What a probe says is divided by the share of surfaces among what it sees round there, so that surfaces beside the open are not darkened; rays into the open then bring nothing, and nothing is asked for them.")
PARAM_FLOAT(blur_limit, 1, 0, 16, 0.5, 4, Linear, Rebuild, "lengths of the ray",
            "sample_weight surface: a probe that blurs what a ray hit over more than this is not asked, and the lightmap read where none is. 0, and by receivers on glossy surfaces with receivers radiance: asked wherever it sees.")
PARAM_INT(surface_reads, 16, 1, 64, 1, 64, Log, Rebuild, "lumels",
          "sample_weight surface: lumels that a receiver reads at most, each for several of its rays. Fewer make places that probes see little of noisier.")
PARAM_FLOAT(least_valid, 0.5, 0, 1, 0, 1, Linear, Live, "share", "A receiver with fewer valid samples than this is marked and counted.")
PARAM_BOOL(clamp_negative, false, Live, "Cuts off what ringing makes negative, at the receiver's whole irradiance (directional receivers: at the pixel's too; radiance: what a pixel reflects). Either way it is counted.")
PARAM_INT(precompute_memory_mb, 512, 1, 65536, 64, 8192, Log, Rebuild, "MiB",
          "Memory that precomputation works in, results apart. Less makes it slower and never changes what is computed.")
PARAM_BOOL(cache, true, Rebuild, "Finished clusters are kept on disk, by content: what was stopped goes on there, and what was done is not done again.")
PARAM_INT(slice_ms, 30, 1, 1000, 5, 200, Log, Live, "ms", "Precomputation done between two frames. Changes how long a frame waits, never the result.")

PARAM_GROUP_END(srp, SrpParams)
