#include "relight/pictures/pixel_lights.h"

#include <algorithm>
#include <array>
#include <bit>
#include <utility>

#include "prt/receivers/lit_position.h"
#include "relight/sharp/light_packets.h"

namespace relumine::relight {

namespace {

/// Pixels on a side of a group: 64 rays, side by side.
constexpr std::uint32_t GroupSize = 8;

} // namespace

LightBeams::LightBeams(std::span<const SharpLight> lights) : num_lights_(lights.size()) {
    for (std::size_t i = 0; i < lights.size(); ++i) {
        if (beams_.empty() || !fits(beams_.back().directions, lights[i]))
            beams_.push_back({.directions = {}, .first_light = i});
        beams_.back().directions.add(glm::vec3(lights[i].direction));
    }
}

/// Points whose lights are found together.
class PixelLights::Group {
public:
    explicit Group(PixelLights& of) : of_(of) {}
    ~Group() { trace(); }
    Group(const Group&) = delete;
    Group& operator=(const Group&) = delete;

    /// Adds a point. `lights` are those to trace, and become those that reach it.
    void add(const EyeSample& sample, std::span<std::uint16_t> lights) {
        const prt::MeshPoint at = sample.point();
        const glm::vec3 normal = prt::mapped_normal(of_.mesh_, at);
        origins_[size_] = prt::ray_origin(
            prt::lit_position(of_.mesh_, of_.rays_, at, normal, of_.bias_), normal, of_.bias_);
        normals_[size_] = normal;
        lights_[size_] = lights;
        mean_normal_ += normal;
        if (++size_ == prt::ReceiverGroup::MaxSize)
            trace();
    }

    void trace() {
        for (const LightBeams::Beam& beam : of_.lights_.beams())
            trace(beam);
        size_ = 0;
        mean_normal_ = glm::vec3(0.0f);
    }

private:
    void trace(const LightBeams::Beam& beam) {
        std::array<std::uint64_t, prt::ReceiverGroup::MaxSize> rays{}; // a bit per direction
        std::uint64_t any = 0;
        for (std::uint32_t j = 0; j < beam.directions.num_directions; ++j) {
            const glm::vec3 direction = beam.directions.direction(j);
            const std::size_t light = beam.first_light + j;
            for (std::size_t i = 0; i < size_; ++i) {
                std::uint16_t& word = lights_[i][light / prt::PacketSize];
                const auto bit = static_cast<std::uint16_t>(1u << light % prt::PacketSize);
                if ((word & bit) == 0)
                    continue;
                word = static_cast<std::uint16_t>(word & ~bit);
                if (prt::is_above(normals_[i], direction))
                    rays[i] |= std::uint64_t{1} << j;
            }
        }
        for (std::size_t i = 0; i < size_; ++i)
            any |= rays[i];
        if (any == 0)
            return;
        of_.blockers_.clear_blocked({std::span(origins_).first(size_), mean_normal_},
                                    beam.directions, std::span(rays).first(size_));
        for (std::size_t i = 0; i < size_; ++i)
            for (std::uint64_t bits = rays[i]; bits != 0; bits &= bits - 1) {
                const std::size_t light =
                    beam.first_light + static_cast<std::size_t>(std::countr_zero(bits));
                std::uint16_t& word = lights_[i][light / prt::PacketSize];
                word = static_cast<std::uint16_t>(word | 1u << light % prt::PacketSize);
            }
    }

    PixelLights& of_;
    std::size_t size_ = 0;
    std::array<glm::vec3, prt::ReceiverGroup::MaxSize> origins_{}, normals_{};
    std::array<std::span<std::uint16_t>, prt::ReceiverGroup::MaxSize> lights_{};
    glm::vec3 mean_normal_{0.0f};
};

void PixelLights::trace(const SampleRectangle& seen, const PixelRectangle& inner) {
    pixels_ = seen.pixels();
    per_pixel_ = seen.pixel(pixels_.left, pixels_.top).size();
    trace_middles(seen);
    trace_uneven(seen, inner);
}

void PixelLights::trace_middles(const SampleRectangle& seen) {
    middles_.assign(pixels_.size() * lights_.num_packets(), 0);
    std::vector<std::uint16_t> all(lights_.num_packets(), 0xffff);
    if (const std::size_t rest = lights_.num_lights() % prt::PacketSize; rest != 0)
        all.back() = static_cast<std::uint16_t>((1u << rest) - 1u);
    for (std::uint32_t top = pixels_.top; top < pixels_.bottom; top += GroupSize)
        for (std::uint32_t left = pixels_.left; left < pixels_.right; left += GroupSize) {
            Group group(*this);
            for (std::uint32_t y = top; y < std::min(top + GroupSize, pixels_.bottom); ++y)
                for (std::uint32_t x = left; x < std::min(left + GroupSize, pixels_.right); ++x)
                    if (const EyeSample& sample = seen.middle(x, y); sample.hits()) {
                        const std::span<std::uint16_t> lights = middle(x, y);
                        std::copy(all.begin(), all.end(), lights.begin());
                        group.add(sample, lights);
                    }
        }
}

/// Finds the lights that a pixel and those around it disagree about. Returns whether there are any.
bool PixelLights::find_doubt(std::uint32_t x, std::uint32_t y, std::span<std::uint16_t> doubt) {
    std::fill(doubt.begin(), doubt.end(), std::uint16_t{0});
    const std::span<const std::uint16_t> own = middle(x, y);
    bool any = false;
    for (std::uint32_t v = y - std::min(y - pixels_.top, 1u); v < std::min(y + 2, pixels_.bottom);
         ++v)
        for (std::uint32_t u = x - std::min(x - pixels_.left, 1u);
             u < std::min(x + 2, pixels_.right); ++u) {
            const std::span<const std::uint16_t> other = middle(u, v);
            for (std::size_t p = 0; p < own.size(); ++p) {
                doubt[p] = static_cast<std::uint16_t>(doubt[p] | (own[p] ^ other[p]));
                any = any || doubt[p] != 0;
            }
        }
    return any;
}

void PixelLights::trace_uneven(const SampleRectangle& seen, const PixelRectangle& inner) {
    uneven_.assign(pixels_.size(), Even);
    const std::size_t words = lights_.num_packets();
    std::vector<std::uint16_t> doubts; // of each uneven pixel
    std::vector<std::uint16_t> doubt(words);
    std::vector<std::pair<std::uint32_t, std::uint32_t>> places;
    for (std::uint32_t top = inner.top; top < inner.bottom; top += GroupSize)
        for (std::uint32_t left = inner.left; left < inner.right; left += GroupSize)
            for (std::uint32_t y = top; y < std::min(top + GroupSize, inner.bottom); ++y)
                for (std::uint32_t x = left; x < std::min(left + GroupSize, inner.right); ++x)
                    if (find_doubt(x, y, doubt)) {
                        uneven_[index(x, y)] = static_cast<std::uint32_t>(places.size());
                        places.emplace_back(x, y);
                        doubts.insert(doubts.end(), doubt.begin(), doubt.end());
                    }
    samples_.assign(places.size() * per_pixel_ * words, 0);
    Group group(*this);
    for (std::size_t i = 0; i < places.size(); ++i) {
        const auto [x, y] = places[i];
        const std::span<const EyeSample> samples = seen.pixel(x, y);
        for (std::size_t s = 0; s < per_pixel_; ++s)
            if (samples[s].hits()) {
                const auto lights =
                    std::span(samples_).subspan((i * per_pixel_ + s) * words, words);
                std::copy_n(doubts.begin() + static_cast<std::ptrdiff_t>(i * words), words,
                            lights.begin());
                group.add(samples[s], lights);
            }
    }
    group.trace();
    // What all around agree about.
    for (std::size_t i = 0; i < places.size(); ++i) {
        const std::span<const std::uint16_t> own = middle(places[i].first, places[i].second);
        for (std::size_t p = 0; p < words; ++p) {
            const auto agreed = static_cast<std::uint16_t>(own[p] & ~doubts[i * words + p]);
            for (std::size_t s = 0; s < per_pixel_; ++s) {
                std::uint16_t& word = samples_[(i * per_pixel_ + s) * words + p];
                word = static_cast<std::uint16_t>(word | agreed);
            }
        }
    }
}

std::span<const std::uint16_t> PixelLights::of(std::uint32_t x, std::uint32_t y,
                                               std::size_t sample) const {
    const std::size_t words = lights_.num_packets(), pixel = index(x, y);
    if (uneven_[pixel] == Even)
        return std::span(middles_).subspan(pixel * words, words);
    return std::span(samples_).subspan((uneven_[pixel] * per_pixel_ + sample) * words, words);
}

} // namespace relumine::relight
