// Draws the relit mesh with the environment behind it.
#pragma once

#include <span>

#include <glm/vec3.hpp>

#include "relumine/in/mesh_files.h"
#include "relumine/out/pictures.h"
#include "viewer/cube_texture.h"
#include "viewer/gl_objects.h"
#include "viewer/look.h"
#include "viewer/orbit_camera.h"

namespace relumine::viewer {

class SceneRenderer {
public:
    SceneRenderer(const mesh::TriangleMesh& mesh, const relight::FadingFloor& floor);
    /// Takes the mesh of the constructor where vertices or triangles have moved.
    void upload_mesh(const mesh::TriangleMesh& mesh);
    /// `radiance` is [num_vertices].
    void upload_radiance(std::span<const glm::vec3> radiance);
    /// Draws into the current viewport, whose shape must be `viewport`. Clears its depth.
    void draw(const OrbitCamera& camera, const PixelRectangle& viewport,
              const CubeTexture& environment, const SceneLook& look,
              const FloorScene& floor = {}) const;
    /// Takes a picture of the whole viewport that was drawn elsewhere.
    void upload_picture(const relight::Picture& picture);
    /// Draws that picture in place of the mesh.
    void draw_picture(const SceneLook& look) const;

private:
    void draw_background(const OrbitCamera& camera, const PixelRectangle& viewport,
                         const CubeTexture& environment, const SceneLook& look,
                         const FloorScene& floor) const;
    void set_behind(const GlProgram& program, const OrbitCamera& camera, const SceneLook& look,
                    const FloorScene& floor) const;

    relight::FadingFloor floor_;
    GlProgram mesh_program_;
    GlProgram background_program_;
    GlProgram picture_program_;
    GlTexture picture_;
    GlVertexArray mesh_array_;
    GlVertexArray no_array_;
    GlBuffer positions_;
    GlBuffer radiance_;
    GlBuffer triangles_;
    GLsizei num_indices_ = 0;
    glm::vec3 center_{0.0f};
    float diagonal_ = 1.0f;
};

} // namespace relumine::viewer
