// From the executor's images to layers of a file, and to one picture that a person looks at.
#pragma once

#include "engine/graph/executor.h"
#include "engine/image/image.h"
#include "engine/scene/scene.h"
#include "samples/cli/job.h"

namespace radivox::cli {

/// The AOV at the size of the picture: means over supersample² pixels (ids: the first of them; irradiance: weighed by
/// albedo, so that at edges too E · ρ/π of the means is the mean of E · ρ/π), absolute positions.
image::Layer downloadAov(gpu::Device& device, graph::Executor& executor, const Job& job, const Aov& aov, const scene::Scene& scene);

/// The layers as the command writes them: one AOV as R, G, B; several under their names.
std::vector<image::Layer> arrangeLayers(std::vector<image::Layer> layers);

/// A layer for the eye, as image::writePng takes it: radiance and irradiance exposed so that the 99th percentile of luminance is 1, albedo as
/// it is, normals and ids as colours.
image::Image displayReferred(const image::Layer& layer);
void writePreview(const std::string& path, const image::Layer& layer);

}  // namespace radivox::cli
