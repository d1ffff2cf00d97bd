// What a precompute is asked for, what stands around it, what it found, and how it may be refused.
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <optional>
#include <stdexcept>
#include <stop_token>
#include <string>
#include <variant>
#include <vector>

#include <glm/vec3.hpp>

#include "prt/bounces/bounce_precompute.h"
#include "prt/glossy/glossy_precompute.h"
#include "prt/glossy/surface_sampling.h"
#include "prt/memory_estimate.h"
#include "prt/precompute_options.h"
#include "prt/receivers/texel_receivers.h"
#include "prt/refinement/refine.h"
#include "prt/visibility/blockers.h"
#include "prt/work.h"
#include "relumine/in/places.h"

namespace relumine {

/// Thrown when a stop token asked for the end.
using prt::Cancelled;

/// The mesh's vertices are lit: pictures from any view, meshes with vertex colours.
struct Vertices {};

/// The pixels of one view are lit: a picture as sharp as its pixels, from that view alone.
struct Pixels {
    std::uint32_t width = 1024;
    std::uint32_t height = 768;
    /// n x n samples a pixel; none: one, and 4 x 4 where a pixel holds an edge, which share
    /// receivers where they see the same surface.
    std::optional<std::uint32_t> samples_per_axis = {};
};

/// The texels of a lightmap on the mesh's uvs are lit.
struct Texels {
    std::uint32_t width = 1024;
    std::uint32_t height = 1024;
};

/// Points in space are lit, which have no surface: each sees the whole sphere. Those of a file are
/// among the coordinates of the mesh's file; `positions` count as the mesh's own do.
struct Points {
    /// A .npy file of [count x 3] numbers, or the vertices of a .ply file. Empty: `positions`.
    std::filesystem::path file = {};
    std::vector<glm::vec3> positions = {};
};

/// The middles of nx x ny x nz cells of a box are lit, as Points.
struct Grid {
    std::uint32_t nx = 0, ny = 0, nz = 0;
    /// Among the coordinates of the mesh's file. Empty: the box around the mesh, without a floor
    /// that was added to it.
    std::optional<PlacedBox> box = {};
};

/// What is lit.
using ReceiverChoice = std::variant<Vertices, Pixels, Texels, Points, Grid>;

/// A view of the scene, among the coordinates of the mesh's file.
struct View {
    /// Empty: a camera that shows the whole mesh.
    std::optional<PlacedCamera> camera = {};
};

/// Parts of a precompute that take time.
enum class Stage {
    /// More vertices for a coarse mesh
    Refinement,
    /// Which points the pixels of a camera see
    Receivers,
    /// Visibility and clusters
    Clusters,
    /// The view-dependent part; only where there are highlights and an eye
    Highlights,
    /// Light from surface to surface; only where it is asked for
    Bounces,
};

/// What on_warning() is told of.
enum class Warning {
    /// Charts of the lightmap overlap
    ChartsOverlap,
    /// Uvs lie outside of 0 to 1
    UvsOutside,
    /// Highlights are left out, as there is no view
    HighlightsWithoutView,
    /// Surfaces are smoother than the finest cells can hold
    TooSmooth,
    /// What surfaces pass on from behind them is left out, as it is that of vertices
    PassedOnLight,
    /// A checkpoint cannot be written; the work goes on
    Checkpoint,
};

/// PrecomputeOptions::tolerance where refined_by_itself() added vertices. New vertices stand where
/// shadows are, so the same root mean square asks for far more clusters. Measured: with this
/// tolerance the light of the vertices is right to half a percent, and what they interpolate to 1 %
/// to 2 %. Pixels have it, too: the light of the Duck is as exact as with a finer one, from a sixth
/// of the clusters.
inline constexpr float ToleranceOfRefined = 0.025f;

/// Where no tolerance is given, it grows until pixels have at most so many clusters: what a still
/// is worth.
inline constexpr std::uint32_t MostClustersOfPixels = 2048;
/// The most clusters where light passes surfaces by chance (blended, glass), each ray of which
/// costs ten times as much: of other receivers, and of pixels.
inline constexpr std::uint32_t MostClustersOfThin = 4096, MostClustersOfThinPixels = 512;

/// PrecomputeOptions::tolerance of points where none is given: with cells of prt::MinLevelOfPoints,
/// nothing more is split as a rule.
inline constexpr float ToleranceOfPoints = 0.1f;

/// Where highlights come from, for receivers with an eye.
enum class Highlights {
    /// The transfer has them: exact, and free of noise
    Stored,
    /// Rays find them when the scene is lit
    Traced,
};

struct PrecomputeOptions {
    /// RMS error of the transfer allowed within a cluster, 1/sr; smaller is finer. Empty: that of
    /// prt::PrecomputeOptions, ToleranceOfRefined or ToleranceOfPoints.
    std::optional<float> tolerance = {};
    /// Replaces `tolerance` if given: the paper's form, which allows larger meshes a larger error.
    std::optional<float> epsilon = {};
    /// Every cell is split at least this often
    std::uint32_t min_level = prt::PrecomputeOptions{}.min_level;
    /// R: cells stop at single texels of a 6 x R x R environment
    std::uint32_t face_resolution = prt::PrecomputeOptions{}.face_resolution;
    /// Lift of the rays' origins off the surface, in the mesh's unit; automatic unless given
    std::optional<float> bias = {};
    /// What blocks light in place of the mesh's triangles; null: these do. It must outlive the
    /// call. The scene does not keep it: LightOptions::blockers. The mesh then gets no vertices
    /// where its own shadows are, light does not bounce unless it is asked for, which is refused,
    /// as stored highlights are, and there are no checkpoints.
    const prt::Blockers* blockers = nullptr;

    /// What is lit
    ReceiverChoice receivers = Vertices{};
    /// The mesh keeps its vertices. Otherwise vertices, those behind bounces included, become more
    /// where the mesh is coarse: refined_by_itself().
    bool no_refine = false;
    /// The camera of pixels, and the eye that highlights are for; of no use to points and grids.
    /// Without one, pixels take the automatic camera; vertices and texels are seen from anywhere
    /// and have no highlights.
    std::optional<View> view = {};
    /// Replaces the mesh's materials; everywhere() makes one surface for the whole mesh. Empty: the
    /// materials stay.
    prt::SurfaceOverride surface = {};
    /// GGX keeps its energy, or is as glTF publishes it: materials and `surface`.
    prt::GgxForm ggx = prt::GgxForm::Whole;
    /// The added floor's own surface; `surface` is not asked for it. A white Lambert one takes its
    /// albedo from the options of each picture.
    prt::Surface floor_surface = {};
    /// Where highlights come from. Rays may find those of pixels only. Empty: rays find those of
    /// pixels; vertices and texels store them.
    std::optional<Highlights> highlights = {};
    /// Relative error of a stored highlight under a small light anywhere
    float glossy_tolerance = prt::GlossyOptions{}.tolerance;

    /// Light bounces from surface to surface; prt::BounceOptions::tolerance. 0: direct light alone.
    /// Empty: vertices that see other surfaces bounce light, within prt::automatic_tolerance().
    /// Surfaces send what their vertices have, so other receivers get the mesh's vertices behind
    /// them (prt::Receivers::num_added).
    std::optional<float> bounce_tolerance = {};
    /// Backs of surfaces send the bounced light that their fronts do; otherwise they are black.
    bool two_sided_bounces = false;

    /// The scene's file keeps the mesh's groups, so that they can be moved: move().
    bool movable = false;

    /// Bytes. Work that is estimated to take more is refused before it begins. Work that turns out
    /// to take more is stopped. Empty: no limit.
    std::optional<std::uint64_t> max_memory = {};

    /// The .prt file to write as soon as the scene is ready; empty: none
    std::filesystem::path output = {};
    /// Time between two checkpoints in the folder OUTPUT.checkpoint; 0: none. Without an output
    /// there are none. The folder goes away when the scene is written.
    double checkpoint_seconds = 20.0;
    /// Continues from a checkpoint of the same work if there is one.
    bool resume = false;
};

/// What stands around a precompute. Nothing of it changes the scene.
struct PrecomputeWork {
    /// Processes that share the work: precompute() runs in the first one, assist() in the others.
    /// There must be no limit of memory.
    prt::Team& team = prt::alone();
    /// Polled a few times a second. A stop request makes precompute() throw Cancelled.
    std::stop_token stop = {};
    /// Estimated fraction of a stage in [0, 1], never falling; one call at a time
    std::function<void(Stage, double)> on_progress = {};
    /// Gets a sentence that the user should read at once. One call at a time.
    std::function<void(Warning, const std::string&)> on_warning = {};
    /// Gets a sentence that helps to understand a run. One call at a time.
    std::function<void(const std::string&)> on_note = {};

    /// The handle of a stage that the processes do not share.
    [[nodiscard]] prt::Work of(Stage stage) const {
        prt::Work work{.stop = stop};
        if (on_progress)
            work.on_progress = [told = on_progress, stage](double fraction) {
                told(stage, fraction);
            };
        return work;
    }
};

/// What one of the processes that share a precompute did.
struct ProcessFigures {
    /// Rays of the clusters
    std::uint64_t num_rays = 0;
    /// From the moment when it got the work to its result
    double seconds = 0.0;
    /// The part of `seconds` that went into waiting for the others and sending
    double seconds_waiting = 0.0;
    /// Processor time of all threads
    double seconds_of_processors = 0.0;
    /// Most bytes of planes of visibility at once
    std::uint64_t plane_bytes = 0;
    /// The process's counts, as bytes of finished clusters
    std::uint64_t column_bytes = 0;
};

/// What a precompute found and took.
struct PrecomputeReport {
    std::size_t num_vertices = 0;
    std::size_t num_triangles = 0;
    std::size_t num_receivers = 0;
    /// Only of a mesh that was refined by itself; num_vertices counts the new ones.
    std::optional<prt::RefineReport> refined = {};
    /// The bias that was used, in the mesh's unit
    float bias = 0.0f;
    prt::PrecomputeStatistics clusters = {};
    /// Only of texels: how the uvs fit the atlas
    std::optional<prt::AtlasReport> atlas = {};
    /// Only of texels: the lightmap takes the mesh's second uvs, since they are an unwrap
    bool takes_second_uvs = false;
    /// Only with a memory limit
    std::optional<prt::MemoryEstimate> memory = {};

    /// Only with highlights
    std::optional<prt::GlossyStatistics> highlights = {};
    /// Entries, from a trial; only with highlights and a memory limit
    std::optional<std::uint64_t> highlights_estimate = {};
    /// Receivers whose highlights were left out, as no view was given
    std::size_t num_highlights_left_out = 0;
    /// Receivers smoother than narrowest_roughness: their highlights come out wider
    std::size_t num_too_smooth = 0;

    /// Only with bounces
    std::optional<prt::BounceStatistics> bounces = {};

    /// By index
    std::vector<ProcessFigures> processes = {};

    /// Size of the scene file, or of the plan, 0 without one
    std::uint64_t file_bytes = 0;
    /// The checkpoint folder if an exception left one, for `resume`; or empty.
    std::filesystem::path checkpoint = {};
};

/// Thrown when a tolerance or a depth asks for so many clusters that the work would take hours. The
/// message says what it would take.
struct TooMuchWork : std::invalid_argument {
    /// What asks for them.
    enum class Cause { Tolerance, MinLevel };
    TooMuchWork(Cause why, const std::string& message)
        : std::invalid_argument(message), cause(why) {}
    Cause cause;
};

/// Thrown when the work would take more memory than max_memory, or takes more. The message is
/// "SOURCE: expected X, got Y".
struct MemoryLimitExceeded : std::runtime_error {
    /// What is too large. This tells what would help.
    enum class Part {
        /// The mesh and its receivers. Only a smaller mesh or fewer receivers help.
        Scene,
        /// The clusters, as estimated beforehand. A larger tolerance helps.
        Clusters,
        /// The clusters, as found while clustering. A checkpoint is left if there were checkpoints.
        ClustersFound,
        /// The highlights. A larger glossy_tolerance helps.
        Highlights,
        /// The bounces. A larger bounce_tolerance helps.
        Bounces,
    };
    MemoryLimitExceeded(Part what, const std::string& message)
        : std::runtime_error(message), part(what) {}
    Part part;
};

} // namespace relumine
