#include "cubemap/image/convention.h"

#include <algorithm>
#include <utility>

#include "cubemap/image/image_layout.h"

namespace relumine::cubemap {

namespace {

constexpr std::array<Layout, 1> LatLongOnly = {Layout::LatLong};
constexpr std::array<Layout, 2> LatLongAndBall = {Layout::LatLong, Layout::MirrorBall};
constexpr std::array<Layout, 3> LatLongAndFaces = {Layout::LatLong, Layout::Cube,
                                                   Layout::HorizontalStrip};
constexpr std::array<Layout, 4> Faces = {Layout::Cube, Layout::HorizontalStrip,
                                         Layout::VerticalCross, Layout::HorizontalCross};
constexpr std::array<Layout, 1> OctahedralOnly = {Layout::Octahedral};

glm::dmat3 diagonal(double x, double y, double z) {
    return {{x, 0.0, 0.0}, {0.0, y, 0.0}, {0.0, 0.0, z}};
}

/// A quarter turn about +Y. It carries +Z, the middle of OpenEXR's lat-long, to +X.
const glm::dmat3 QuarterTurn = {{0.0, 0.0, -1.0}, {0.0, 1.0, 0.0}, {1.0, 0.0, 0.0}};

const std::array<Convention, 10> Conventions = {
    // Source:  ImfEnvmap.h.
    Convention{
        .name = "openexr",
        .mathematics =
            "u = 1/2 - atan2(x, z) / 2 pi, v = acos(y) / pi; cube faces +X -X +Y -Y +Z -Z as "
            "ImfEnvmap.h draws them; samples on the borders in .exr",
        .layouts = AllLayouts,
        .has_attribute = true},
    // Source:  UsdLuxDomeLight, "adheres to the OpenEXR specification for latitude-longitude
    //          maps".
    Convention{.name = "usd",
               .mathematics =
                   "u = 1/2 - atan2(x, z) / 2 pi, v = acos(y) / pi (DomeLight, pole axis Y)",
               .layouts = LatLongOnly},
    // Source:  Mitsuba 3, emitter `envmap`, eval(): u = atan2(x, -z) / 2 pi, v = acos(y) / pi.
    //          This is OpenEXR's mapping.
    Convention{.name = "mitsuba",
               .mathematics = "u = atan2(x, -z) / 2 pi mod 1, v = acos(y) / pi (emitter "
                              "envmap, identity to_world)",
               .layouts = LatLongOnly},
    // Source:  Cycles, direction_to_equirectangular() and direction_to_mirrorball() in
    //          kernel/camera/projection.h. The middle of the lat-long is Blender's +X. The
    //          middle of the ball is Blender's -Y, our +Z.
    Convention{
        .name = "blender",
        .mathematics =
            "u = 1/2 - atan2(y, x) / 2 pi, v = acos(z) / pi in Blender's axes, Z up: Blender's "
            "(x, y, z) is our (x, z, -y)",
        .layouts = LatLongAndBall,
        .world_from_lat_long = QuarterTurn},
    // Source:  equirectUv() in three.js' ShaderChunk `common`. Cubes are looked up at (-x, y,
    //          z) (flipEnvMap) in OpenGL's faces.
    Convention{.name = "threejs",
               .mathematics = "u = 1/2 + atan2(z, x) / 2 pi, v = acos(y) / pi; six files: "
                              "OpenGL's faces at (-x, y, z)",
               .layouts = LatLongAndFaces,
               .world_from_lat_long = QuarterTurn,
               .world_from_faces = diagonal(-1.0, 1.0, -1.0),
               .swaps_z_faces = true},
    // Source:  measured with Babylon.js 9.31: the middle is +Z and the left quarter -X in its
    //          left-handed scenes, and the middle -Z in right-handed ones.
    Convention{.name = "babylonjs",
               .mathematics = "u = 1/2 + atan2(x, -z) / 2 pi, v = acos(y) / pi (right-handed "
                              "scenes; left-handed ones have our (x, y, -z))",
               .layouts = LatLongOnly,
               .world_from_lat_long = diagonal(-1.0, 1.0, -1.0)},
    // Source:  OpenGL 4.6, table 8.19. With the world direction as the texture coordinate, sc,
    //          tc = (-z, -y) (z, -y) (x, z) (x, -z) (x, -y) (-x, -y).
    Convention{.name = "opengl",
               .mathematics = "cube faces of OpenGL's table 8.19 looked up at (x, y, z): "
                              "OpenEXR's with +Z and -Z "
                              "exchanged and z negated",
               .usual_layout = Layout::Cube,
               .layouts = Faces,
               .world_from_faces = diagonal(1.0, 1.0, -1.0),
               .swaps_z_faces = true},
    // Source:  Direct3D 9 and later, "Cubic Environment Mapping": the same faces in a
    //          left-handed world.
    Convention{.name = "directx",
               .mathematics = "the same faces looked up at (x, y, z) in Direct3D's left-handed "
                              "axes, our (x, y, -z): "
                              "OpenEXR's with +Z and -Z exchanged",
               .usual_layout = Layout::Cube,
               .layouts = Faces,
               .swaps_z_faces = true},
    // Source:  pbrt-v4, EqualAreaSquareToSphere() with Z up as in imgtool makeequiarea.
    //          Layout::Octahedral already has these axes.
    Convention{.name = "pbrt",
               .mathematics = "(u, v) = EqualAreaSphereToSquare(x, y, z) in pbrt's axes, Z up: "
                              "pbrt's (x, y, z) is our "
                              "(x, z, -y)",
               .usual_layout = Layout::Octahedral,
               .layouts = OctahedralOnly},
    // Source:  pbrt-v2 and pbrt-v3, InfiniteAreaLight::Le(): s = SphericalPhi(w) / 2 pi, t =
    //          SphericalTheta(w) / pi.
    Convention{.name = "pbrt-v2",
               .mathematics = "u = atan2(y, x) / 2 pi mod 1, v = acos(z) / pi in pbrt's axes, "
                              "Z up (also pbrt-v3): pbrt's (x, y, z) is our (x, z, -y)",
               .layouts = LatLongOnly,
               .world_from_lat_long = {{0.0, 0.0, -1.0}, {0.0, 1.0, 0.0}, {-1.0, 0.0, 0.0}}},
};

} // namespace

bool Convention::reads(Layout layout) const {
    return std::find(layouts.begin(), layouts.end(), layout) != layouts.end();
}

const glm::dmat3& Convention::world_from(Layout layout) const {
    static const glm::dmat3 Same(1.0);
    if (layout == Layout::LatLong)
        return world_from_lat_long;
    return has_faces(layout) ? world_from_faces : Same;
}

std::span<const Convention> conventions() {
    return Conventions;
}

const Convention* find_convention(std::string_view name) {
    const auto found = std::find_if(Conventions.begin(), Conventions.end(),
                                    [&](const Convention& each) { return each.name == name; });
    return found == Conventions.end() ? nullptr : &*found;
}

void swap_z_faces(EnvironmentImage& image) {
    if (image.layout != Layout::Cube && image.layout != Layout::HorizontalStrip)
        return;
    const FaceSquares squares(image.layout, image.width, image.height);
    for (std::uint32_t y = 0; y < squares.resolution(); ++y) {
        for (std::uint32_t x = 0; x < squares.resolution(); ++x)
            std::swap(image.pixels[squares.pixel(Face::PositiveZ, x, y)],
                      image.pixels[squares.pixel(Face::NegativeZ, x, y)]);
    }
}

void take_faces(const Convention& convention, EnvironmentImage& image) {
    if (!convention.swaps_z_faces || image.faces_of == FacesOf::Direct3D)
        return;
    swap_z_faces(image);
    if (image.faces_of == FacesOf::OpenExr ||
        (image.layout != Layout::Cube && image.layout != Layout::HorizontalStrip))
        return;
    // The reader undid OpenGL's mirror along Z.
    const FaceSquares squares(image.layout, image.width, image.height);
    const std::uint32_t size = squares.resolution();
    for (const Face face : AllFaces)
        for (std::uint32_t i = 0; i < size; ++i)
            for (std::uint32_t k = 0; k < size / 2; ++k) {
                const bool is_vertical = face == Face::PositiveY || face == Face::NegativeY;
                const auto pixel = [&](std::uint32_t at) {
                    return is_vertical ? squares.pixel(face, i, at) : squares.pixel(face, at, i);
                };
                std::swap(image.pixels[pixel(k)], image.pixels[pixel(size - 1 - k)]);
            }
}

} // namespace relumine::cubemap
