// The light of a scene's receivers, as pictures need it.
#pragma once

#include <memory>
#include <optional>
#include <span>
#include <vector>

#include <glm/vec3.hpp>

#include "cubemap/cube_map.h"
#include "prt/glossy/lobes.h"
#include "relight/pictures/backdrop.h"
#include "relight/sharp/sharp_lights.h"
#include "relumine/light/light.h"

namespace relumine {

/// What a picture is drawn of.
struct Lighting {
    /// [num_receivers], as LitScene::radiance().
    std::span<const glm::vec3> radiance;
    /// [num_receivers] the same without what surfaces pass on from behind them, which pictures of
    /// vertices find at each pixel. Empty: they pass none on.
    std::span<const glm::vec3> reflected = {};
    /// What pictures of vertices are drawn of.
    [[nodiscard]] std::span<const glm::vec3> drawn() const {
        return reflected.empty() ? radiance : reflected;
    }
    /// [num_receivers] what arrives of it without a bounce, as radiance for albedo 1, for light
    /// meters. Empty: unknown.
    std::span<const glm::vec3> arriving = {};
    /// Must outlive this object. Null: there is nothing behind the mesh but black.
    const cubemap::CubeMap* environment = nullptr;
    /// What is seen of it behind the mesh. Null: all of it.
    std::shared_ptr<const cubemap::CubeMap> seen = nullptr;
    /// What is seen, from the environment's own pixels. Empty: from the cube map.
    relight::Backdrop sharp = {};
    /// The lights that are traced one by one, and [num_receivers] radiance without them. Empty:
    /// radiance has all light.
    std::vector<relight::SharpLight> lights = {};
    /// The first so many are parts of `environment`.
    std::size_t num_environment_lights = 0;
    std::vector<glm::vec3> soft = {};
    /// Bright cells of the environment that pictures trace on an added floor, and [vertices of the
    /// floor] what `radiance` and `soft` have of them, for albedo 1. Empty: there are none.
    std::vector<relight::SharpLight> floor_lights = {};
    std::vector<glm::vec3> of_floor_lights = {};
    /// [num_receivers] what `soft` is made of, or `radiance` where there are no lights, without
    /// bounces. Only of meshes with textures and highlights.
    std::vector<prt::Lobes<glm::vec3>> lobes = {};
    /// [num_receivers][coefficients] what arrives of `soft`, or of `radiance` where there are no
    /// lights, as spherical harmonics and without bounces. Only of vertices of meshes with normal
    /// maps.
    std::vector<glm::vec3> harmonics = {};
    /// [num_receivers] radiance that surfaces send, and what receivers have of the soft light of
    /// surfaces and sky, for albedo 1: pictures of rooms gather this anew at the points that they
    /// show (relight/pictures/gathered_light.h). Empty: they do not.
    std::vector<glm::vec3> sent = {}, replaced = {};
    /// The radiance, for albedo 1, of a level floor that nothing shades. Empty: unknown, and floors
    /// catch no shadows.
    std::optional<glm::vec3> open_floor = {};
    /// What layers and added lights make of that: its factor over the light of the base alone.
    glm::vec3 open_gain{1.0f};
    /// The environment's state, whose layers make `open_gain`. Must outlive this object; null:
    /// none.
    const LightState* state = nullptr;
    /// What `radiance` and `reflected` point to, where they were gathered from several processes.
    std::shared_ptr<const std::vector<glm::vec3>> gathered = {}, gathered_reflected = {};

    /// What is behind the mesh. Not where there is nothing.
    [[nodiscard]] const cubemap::CubeMap& behind() const { return seen ? *seen : *environment; }
};

} // namespace relumine
