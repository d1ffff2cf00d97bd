// The state that the window's panels and scripts share: the scene, the desk, both views, what is
// shown and chosen. Works without a window.
#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "relumine/ask/questions.h"
#include "relumine/in/environment_files.h"
#include "relumine/in/mesh_files.h"
#include "relumine/in/scene_rays.h"
#include "relumine/light/layers.h"
#include "relumine/light/live_eye.h"
#include "relumine/out/output.h"
#include "relumine/out/pictures.h"
#include "relumine/out/probe_balls.h"
#include "viewer/gestures.h"
#include "viewer/lat_long_view.h"
#include "viewer/light_desk.h"
#include "viewer/look.h"
#include "viewer/orbit_camera.h"
#include "viewer/refiner.h"
#include "viewer/thing_hand.h"

namespace relumine::viewer {

enum class Tool { Move, Paint, Lasso };

/// What a click on the mesh does.
enum class Click { Ask, Face, Mirror, Move };

struct ViewState {
    /// What is drawn: the scene's mesh, or balls and the mesh.
    const mesh::TriangleMesh& mesh;
    const prt::RayScene& rays;
    LightDesk& desk;
    Shading shading;
    /// How pictures show the floor.
    OutputOptions picture = {};
    /// Reads an environment file as the command line's options say. Throws std::runtime_error.
    std::function<Environment(const std::filesystem::path&)> load_environment;

    Gestures hand = Gestures(desk);
    ThingHand thing = ThingHand(desk);
    OrbitCamera camera = {};
    LatLongView lat_long = {};
    SceneLook scene_look = {};
    EnvironmentLook environment_look = {};

    Tool tool = Tool::Move;
    Click click = Click::Ask;
    /// The pointer places the chosen layer on the mesh.
    bool is_aiming = false;
    /// The contribution map must be made anew.
    bool heat_is_stale = false;
    /// The text field takes the keyboard.
    bool wants_path = false;
    bool message_is_error = false;
    cubemap::LightLayer brush{.name = "Stroke", .region = cubemap::Stroke::as_added()};
    cubemap::LightLayer lasso{.name = "Lasso",
                              .region = cubemap::Lasso::as_added(),
                              .effect = cubemap::Gain{.factor = 0.25f}};

    /// Where keys steer the eye: right, up and forward.
    glm::vec3 steering{0.0f};
    /// The roughness of all surfaces that highlights follow the eye on, as it shall be.
    float roughness = 0.0f;

    /// The vertex that was clicked.
    std::optional<std::uint32_t> receiver = {};

    /// Key frames of the layer file, kept for saving.
    std::vector<cubemap::KeyFrame> frames = {};
    /// Content of the text field.
    std::string path = {};
    /// A dropped picture, until the dialogue has asked how to use it; empty: none.
    std::filesystem::path dropped = {};
    std::string message = {};
    double frame_seconds = 0.0;

    /// Shows the points of the scene; null: its receivers are vertices.
    const ProbeBalls* balls = nullptr;

    /// Highlights that follow the eye, and how finely; null: the scene has none.
    std::unique_ptr<LiveEye> live_eye = {};
    EyeOptions eye_options = {};
};

/// Returns what is seen behind the mesh now, for a Refiner. It does not change any more.
[[nodiscard]] relight::Backdrop backdrop_of(const ViewState& state);

/// Returns the camera that `relumine relight` takes for a picture of this size with these options.
[[nodiscard]] OrbitCamera camera_on_all(const Scene& scene, const PixelRectangle& viewport,
                                        OutputOptions options = {});

/// Chooses the receiver nearest to the point where a pixel's ray meets the mesh, or none, and shows
/// the light that reaches it.
void click_mesh(ViewState& state, const PixelRectangle& viewport, const glm::vec2& pixel);

/// Moves a layer so that its light falls on the point of the mesh that a pixel shows. This is not a
/// step of undo yet. Returns false, and changes nothing, where the pixel shows no mesh.
bool aim_light(ViewState& state, std::size_t layer, const PixelRectangle& viewport,
               const glm::vec2& pixel, Aim aim);

/// Takes the thing of the scene that a pixel shows, or says in `message` why not.
void take_thing(ViewState& state, const PixelRectangle& viewport, const glm::vec2& pixel);
/// Lets the thing that is held follow the pointer: over a level plane, or before the eye.
void drag_thing(ViewState& state, const PixelRectangle& viewport, const glm::vec2& pixel,
                bool is_before_eye, double turn_degrees);
void drop_thing(ViewState& state);

// Files. These functions report success or failure in `message` and return false for a failure.
// They do not throw for errors of files.

/// Takes a file that was dropped on the window: a .json opens, a picture becomes `dropped`.
bool drop(ViewState& state, const std::filesystem::path& path);
/// Adds a picture, .exr or .hdr, as a layer where the environment's view looks.
bool add_image(ViewState& state, const std::filesystem::path& path);
/// Opens layers from .json, with the environment that they name, or an environment from .exr or
/// .hdr.
bool open(ViewState& state, const std::filesystem::path& path);
bool save_layers(ViewState& state, const std::filesystem::path& path);
/// Saves base and layers as one lat-long, .exr or .hdr.
bool save_environment(ViewState& state, const std::filesystem::path& path);
/// Saves what the scene's view shows, as `relumine relight` draws it from this camera: .png as in
/// the window, .exr linear and without exposure.
bool save_picture(ViewState& state, const PixelRectangle& viewport,
                  const std::filesystem::path& path);
/// Returns the path of the text field where it names a picture that does not exist yet, otherwise
/// the first of picture-1.png, picture-2.png, ... that does not.
[[nodiscard]] std::filesystem::path new_picture(const ViewState& state);

} // namespace relumine::viewer
