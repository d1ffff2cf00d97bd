// Draws a tile of a picture.
#pragma once

#include <cstdint>
#include <span>
#include <utility>
#include <vector>

#include <glm/vec3.hpp>

#include "mesh/triangle_mesh.h"
#include "prt/receivers/texture_view.h"
#include "prt/visibility/ray_scene.h"
#include "relight/pictures/backdrop.h"
#include "relight/pictures/backdrop_pixels.h"
#include "relight/pictures/eye_samples.h"
#include "relight/pictures/floor_shadows.h"
#include "relight/pictures/gathered_light.h"
#include "relight/pictures/picture_view.h"
#include "relight/pictures/pixel_lights.h"
#include "relight/pictures/seen_mesh.h"
#include "relight/sharp/light_packets.h"
#include "relight/sharp/shadow_rays.h"
#include "relight/surfaces/mirrors.h"
#include "relight/surfaces/refractions.h"
#include "relight/surfaces/sample_shading.h"

namespace relumine::relight {

/// What all tiles of a picture share.
struct TileScene {
    const mesh::TriangleMesh& mesh;
    const prt::RayScene& rays;
    const SeenMesh& seen;
    const glm::vec3& eye;
    const prt::PictureRays& grid;
    const FadingFloor& floor;
    const EyeSamples& samples;
    const PictureTiles& tiles;
    const MeshLight& light;
    const LightPackets& packets;
    const LightBeams& beams;
    const FloorLights& floor_lights;
    /// Null: the mesh is drawn alone, with its alpha.
    const Backdrop* backdrop = nullptr;
    /// Null: bounced light is that of the vertices.
    const GatheredLight* gathered = nullptr;
};

/// Draws squares of pixels, one after the other. For one thread.
class PictureTile {
public:
    /// The scene and all of it must outlive this object.
    explicit PictureTile(const TileScene& scene);

    /// Draws a tile into the picture.
    void draw(std::uint32_t tile, Picture& picture);

private:
    struct Pixel {
        glm::vec3 color;
        float alpha;
    };
    /// What a sample sees, one behind the other.
    struct Layer {
        EyeSample sample;
        mesh::Veil veil = {};
        bool is_first = true;
    };
    /// A sample that is shaded.
    struct SeenAt {
        EyeSample sample;
        glm::vec3 direction{0.0f};
        std::size_t number = 0;
        /// Whether its lights are known with those of its pixel.
        bool is_known = true;
    };
    /// Samples of a pixel that are shaded as one: the sum of their places in a triangle.
    struct Part {
        EyeSample sum;
        float count = 0.0f;
        /// The first of them.
        std::size_t first = 0;
    };
    /// What a sample shows, premultiplied, and how it changes what is behind.
    struct Shown {
        glm::vec3 color{0.0f};
        glm::vec3 passed{1.0f};
        float covered = 0.0f;
    };

    void look_into_mirrors(const SampleRectangle& seen);
    [[nodiscard]] Pixel drawn(std::uint32_t x, std::uint32_t y, std::span<const EyeSample> samples);
    /// Whether samples in a triangle may be shaded as one: what they show is linear.
    [[nodiscard]] bool is_linear(std::uint32_t triangle) const;
    void find_parts(std::span<const EyeSample> samples, bool is_even);
    [[nodiscard]] Shown shown(std::uint32_t x, std::uint32_t y, const SeenAt& at);
    /// Returns the mean of what further samples of a pixel show, premultiplied, and their number.
    [[nodiscard]] std::pair<glm::vec3, float> further(std::uint32_t x, std::uint32_t y);
    /// Finds the lights that reach a point: own_lights_.
    void trace_own(const prt::MeshPoint& at);
    [[nodiscard]] std::span<const Layer> layers(const SeenAt& at);
    [[nodiscard]] float opacity(const EyeSample& sample) const;
    [[nodiscard]] bool is_floor(const EyeSample& sample) const {
        return scene_.floor.has(scene_.mesh.triangles[sample.triangle]);
    }
    [[nodiscard]] bool has_floor_lights() const { return !scene_.light.floor_lights.empty(); }

    const TileScene& scene_;
    ShadowRays rays_;
    /// Used where triangles have textures.
    prt::TextureView texture_view_;
    Mirrors mirrors_;
    Refractions refractions_;
    SampleShading shading_;
    PixelLights lights_;
    FloorShadows floor_shadows_;
    /// Scratch: [packets]
    std::vector<std::uint16_t> own_lights_;
    /// Scratch of layers()
    std::vector<Layer> layers_;
    std::vector<prt::RayScene::Layer> found_;
    /// The parts of a pixel
    std::vector<Part> parts_;
    /// [samples of a pixel] their parts.
    std::vector<std::size_t> part_of_;
    /// [samples of a pixel] what passes of the light behind.
    std::vector<glm::vec3> passed_;
};

} // namespace relumine::relight
