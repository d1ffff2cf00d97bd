#include "cubemap/resample/resample_projection.h"

#include <span>
#include <vector>

#include "cubemap/image/footprint.h"
#include "cubemap/image/projection.h"
#include "cubemap/resample/pixel_shares.h"
#include "cubemap/spherical_overlap.h"

namespace relumine::cubemap::detail {

namespace {

/// Sums that become means, added in the order of the shares.
class Means {
public:
    explicit Means(std::size_t size) : sums_(size, glm::dvec3(0.0)), weights_(size, 0.0) {}
    void add(std::size_t i, const glm::vec3& radiance, double weight) {
        sums_[i] += glm::dvec3(radiance) * weight;
        weights_[i] += weight;
    }
    void write(std::vector<glm::vec3>& out) const {
        for (std::size_t i = 0; i < out.size(); ++i)
            out[i] = weights_[i] > 0.0 ? glm::vec3(sums_[i] / weights_[i]) : glm::vec3(0.0f);
    }

private:
    std::vector<glm::dvec3> sums_;
    std::vector<double> weights_;
};

} // namespace

CubeMap cube_from_projection(const EnvironmentImage& image, std::uint32_t resolution) {
    CubeMap map(resolution);
    Means means(map.texels.size());
    for_each_row_of_shares(
        shape_of(image), glm::dmat3(1.0), resolution, [&](std::span<const PixelShare> shares) {
            for (const PixelShare& share : shares)
                means.add(share.texel, image.pixels[share.pixel], share.solid_angle);
        });
    means.write(map.texels);
    return map;
}

} // namespace relumine::cubemap::detail
