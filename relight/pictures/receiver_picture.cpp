#include "relight/pictures/receiver_picture.h"

#include <algorithm>
#include <stdexcept>
#include <vector>

#include <fmt/format.h>

#include "files/parallel.h"
#include "relight/pictures/backdrop_pixels.h"

namespace relumine::relight {

namespace {

void require_one_per_receiver(std::size_t num_receivers, std::span<const glm::vec3> radiance) {
    if (radiance.size() != num_receivers)
        throw std::invalid_argument(fmt::format("expected the radiance of {} receivers, got {}",
                                                num_receivers, radiance.size()));
}

/// The surfaces that a sample shows one behind the other.
class SampleLayers {
public:
    /// Returns what the radiance of the next surface counts in the sample.
    glm::vec3 next(const glm::vec3& opacity, const mesh::Veil& veil) {
        const glm::vec3 part = veil.weight * through_ * opacity;
        taken_ += through_ * opacity * (1.0f - veil.through);
        through_ = 1.0f - taken_;
        return part;
    }
    /// The light from behind that comes through so far.
    [[nodiscard]] const glm::vec3& through() const { return through_; }
    [[nodiscard]] float alpha() const {
        return std::clamp((taken_.r + taken_.g + taken_.b) / 3.0f, 0.0f, 1.0f);
    }

private:
    glm::vec3 taken_{0.0f}, through_{1.0f};
};

/// The receivers of a layout's samples, sample by sample.
class SampleReceivers {
public:
    /// Begins with the first sample of a pixel.
    SampleReceivers(const prt::PixelLayout& layout, std::size_t pixel)
        : layout_(layout), next_(static_cast<std::size_t>(
                               std::lower_bound(layout.samples.begin(), layout.samples.end(),
                                                pixel * layout.samples_per_pixel()) -
                               layout.samples.begin())) {}

    /// Calls visit(receiver) for all that a sample sees, nearest first. Samples ascend from call to
    /// call.
    template<typename Visit>
    void visit(std::size_t sample, const Visit& visit) {
        const std::vector<std::uint32_t>& samples = layout_.samples;
        if (layout_.shares.empty()) {
            for (; next_ < samples.size() && samples[next_] == sample; ++next_)
                visit(next_);
            return;
        }
        const std::size_t per_pixel = prt::PixelLayout::EdgeSamples, pixel = sample / per_pixel;
        while (next_ < samples.size() && samples[next_] / per_pixel < pixel)
            ++next_;
        for (std::size_t i = next_; i < samples.size() && samples[i] / per_pixel == pixel; ++i)
            if (((layout_.shares[i] >> sample % per_pixel) & 1u) != 0)
                visit(i);
    }

private:
    const prt::PixelLayout& layout_;
    std::size_t next_;
};

/// Averages the samples of each pixel. `behind(x, y, passed)` is what a pixel shows behind samples
/// that let so much through. The mean opacity goes to the picture's alpha if asked for.
template<typename Behind>
Picture averaged(const prt::PixelLayout& layout, std::span<const glm::vec3> radiance,
                 std::span<const glm::vec3> opacity, std::span<const mesh::Veil> veils,
                 const Behind& behind, bool with_alpha) {
    require_one_per_receiver(layout.samples.size(), radiance);
    if (!opacity.empty() && opacity.size() != radiance.size())
        throw std::invalid_argument("expected one opacity per receiver");
    if (!veils.empty() && veils.size() != radiance.size())
        throw std::invalid_argument("expected one veil per receiver");
    const std::size_t num_pixels = std::size_t{layout.width} * layout.height;
    Picture picture{.width = layout.width, .height = layout.height};
    picture.pixels.resize(num_pixels);
    if (with_alpha)
        picture.alpha.resize(num_pixels);
    const auto per_pixel = static_cast<std::uint32_t>(layout.samples_per_pixel());
    files::parallel_for(std::uint32_t{0}, layout.height, [&](std::uint32_t y) {
        std::size_t pixel = std::size_t{y} * layout.width;
        SampleReceivers receivers(layout, pixel);
        std::vector<glm::vec3> passed(per_pixel);
        for (std::uint32_t x = 0; x < layout.width; ++x, ++pixel) {
            glm::vec3 sum(0.0f);
            float alpha = 0.0f;
            for (std::uint32_t i = 0; i < per_pixel; ++i) {
                SampleLayers layers;
                receivers.visit(pixel * per_pixel + i, [&](std::size_t receiver) {
                    const glm::vec3 own = opacity.empty() ? glm::vec3(1.0f) : opacity[receiver];
                    const mesh::Veil veil = veils.empty() ? mesh::Veil() : veils[receiver];
                    sum += layers.next(own, veil) * radiance[receiver];
                });
                passed[i] = layers.through();
                alpha += layers.alpha();
            }
            picture.pixels[pixel] = sum / static_cast<float>(per_pixel) + behind(x, y, passed);
            if (with_alpha)
                picture.alpha[pixel] = alpha / static_cast<float>(per_pixel);
        }
    });
    return picture;
}

/// Fills texels around the charts, ring by ring.
class Gutter {
public:
    Gutter(Picture& picture, const std::vector<std::uint32_t>& texels)
        : picture_(picture), ring_of_(picture.pixels.size(), Empty), ring_(texels) {
        for (const std::uint32_t texel : texels)
            ring_of_[texel] = 0;
    }

    void grow(std::uint32_t num_rings) {
        for (std::uint32_t ring = 1; ring <= num_rings && !ring_.empty(); ++ring) {
            std::vector<std::uint32_t> next;
            for (const std::uint32_t texel : ring_)
                for_neighbours(texel, [&](std::uint32_t neighbour) {
                    if (ring_of_[neighbour] == Empty) {
                        ring_of_[neighbour] = ring;
                        next.push_back(neighbour);
                    }
                });
            for (const std::uint32_t texel : next)
                picture_.pixels[texel] = mean_of_neighbours(texel, ring);
            ring_ = std::move(next);
        }
    }

private:
    static constexpr std::uint32_t Empty = ~std::uint32_t{0};

    template<typename Visit>
    void for_neighbours(std::uint32_t texel, const Visit& visit) const {
        const std::uint32_t x = texel % picture_.width;
        const std::uint32_t y = texel / picture_.width;
        for (std::uint32_t v = y - std::min(y, 1u); v <= std::min(y + 1, picture_.height - 1); ++v)
            for (std::uint32_t u = x - std::min(x, 1u); u <= std::min(x + 1, picture_.width - 1);
                 ++u)
                visit(v * picture_.width + u);
    }

    [[nodiscard]] glm::vec3 mean_of_neighbours(std::uint32_t texel, std::uint32_t ring) const {
        glm::vec3 sum(0.0f);
        std::uint32_t count = 0;
        for_neighbours(texel, [&](std::uint32_t neighbour) {
            if (ring_of_[neighbour] < ring) {
                sum += picture_.pixels[neighbour];
                ++count;
            }
        });
        return sum / static_cast<float>(count);
    }

    Picture& picture_;
    /// [height * width] ring of each texel; 0: a receiver.
    std::vector<std::uint32_t> ring_of_;
    /// Texels of the outermost ring.
    std::vector<std::uint32_t> ring_;
};

} // namespace

Picture compose_cut_out(const prt::PixelLayout& layout, std::span<const glm::vec3> radiance,
                        std::span<const glm::vec3> opacity, std::span<const mesh::Veil> veils) {
    return averaged(
        layout, radiance, opacity, veils, [](auto, auto, const auto&) { return glm::vec3(0.0f); },
        true);
}

std::vector<glm::vec3> cut_out_transpose(const prt::PixelLayout& layout,
                                         std::span<const glm::vec3> weights,
                                         std::span<const mesh::Veil> veils) {
    const std::size_t num_pixels = std::size_t{layout.width} * layout.height;
    if (weights.size() != num_pixels)
        throw std::invalid_argument(
            fmt::format("expected weights of {} pixels, got {}", num_pixels, weights.size()));
    std::vector<glm::vec3> result(layout.samples.size(), glm::vec3(0.0f));
    const std::size_t per_pixel = layout.samples_per_pixel();
    SampleReceivers receivers(layout, 0);
    for (std::size_t sample = 0; sample < layout.num_samples(); ++sample) {
        SampleLayers layers;
        receivers.visit(sample, [&](std::size_t i) {
            result[i] += layers.next(glm::vec3(1.0f), veils.empty() ? mesh::Veil() : veils[i]) *
                         weights[sample / per_pixel] / static_cast<float>(per_pixel);
        });
    }
    return result;
}

Picture compose(const prt::PixelLayout& layout, std::span<const glm::vec3> radiance,
                const Backdrop& backdrop, std::span<const glm::vec3> opacity,
                std::span<const mesh::Veil> veils) {
    const prt::PictureRays rays(layout.camera, layout.width, layout.height,
                                layout.samples_per_axis);
    return averaged(
        layout, radiance, opacity, veils,
        [&](auto x, auto y, const auto& passed) {
            return BackdropPixels(rays, backdrop, {x, y, x + 1, y + 1}).seen(x, y, passed);
        },
        false);
}

Picture compose(const prt::TexelLayout& layout, std::span<const glm::vec3> radiance,
                std::uint32_t gutter) {
    require_one_per_receiver(layout.texels.size(), radiance);
    Picture picture{.width = layout.width, .height = layout.height};
    picture.pixels.resize(layout.num_texels());
    picture.alpha.resize(layout.num_texels());
    for (std::size_t i = 0; i < layout.texels.size(); ++i) {
        picture.pixels[layout.texels[i]] = radiance[i];
        picture.alpha[layout.texels[i]] = 1.0f;
    }
    Gutter(picture, layout.texels).grow(gutter);
    return picture;
}

Picture compose_rows(const prt::PlaceGrid& rows, std::span<const glm::vec3> radiance) {
    Picture picture{.width = rows.width, .height = rows.height};
    picture.pixels.assign(radiance.begin(), radiance.end());
    picture.pixels.resize(std::size_t{rows.width} * rows.height, glm::vec3(0.0f));
    picture.alpha.resize(picture.pixels.size());
    std::fill_n(picture.alpha.begin(), radiance.size(), 1.0f);
    return picture;
}

} // namespace relumine::relight
