#include "cubemap/quick_turns.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <stdexcept>
#include <utility>

#include <glm/matrix.hpp>

#include "cubemap/luminance.h"
#include "cubemap/turned_texels.h"
#include "files/parallel.h"

namespace relumine::cubemap {

namespace {

static_assert(QuickTurns::MinResolution >= TurnedTexels::MinResolution);

// A texel that differs from the mean of its neighbours by this part of the map's power stands at a
// bright edge. Less than that is lost among texels that err to either side.
constexpr double EdgeShare = 1.0 / 16384.0;

} // namespace

QuickTurns::QuickTurns(std::shared_ptr<const CubeMap> map)
    : map_(std::move(map)), stride_(map_->resolution + std::size_t{2}),
      texels_(NumFaces * stride_ * stride_) {
    const std::uint32_t r = map_->resolution;
    if (r < MinResolution)
        throw std::invalid_argument("expected a map that is worth turning quickly");
    // Over the edges of a face lies what its neighbours have there.
    files::parallel_for(std::size_t{0}, NumFaces * stride_, [&](std::size_t line) {
        const Face face = AllFaces[line / stride_];
        const std::size_t y = line % stride_;
        for (std::size_t x = 0; x < stride_; ++x) {
            const bool is_inside = x > 0 && x <= r && y > 0 && y <= r;
            const glm::vec3 radiance =
                is_inside
                    ? map_->at(face, static_cast<std::uint32_t>(x - 1),
                               static_cast<std::uint32_t>(y - 1))
                    : sample(*map_, glm::vec3(cube_point(face, (static_cast<double>(x) - 0.5) / r,
                                                         (static_cast<double>(y) - 0.5) / r)));
            texels_[line * stride_ + x] = {{radiance.x, radiance.y, radiance.z, 0.0f}};
        }
    });
    // Bright edges, then what lies within a texel of one.
    const double least = EdgeShare * luminance(total_power(*map_));
    const std::vector<double> angles = texel_solid_angles(r);
    std::vector<unsigned char> is_edge(texels_.size());
    const auto brightness = [&](std::size_t at) {
        const auto& values = texels_[at].values;
        return luminance(double{values[0]}, double{values[1]}, double{values[2]});
    };
    files::parallel_for(std::size_t{0}, NumFaces * r, [&](std::size_t row) {
        const std::size_t y = row % r;
        const std::size_t line = (row / r * stride_ + y + 1) * stride_;
        for (std::size_t x = 0; x < r; ++x) {
            const std::size_t at = line + x + 1;
            const double around = 0.25 * (brightness(at - 1) + brightness(at + 1) +
                                          brightness(at - stride_) + brightness(at + stride_));
            is_edge[at] = std::abs(brightness(at) - around) * angles[y * r + x] > least ? 1 : 0;
        }
    });
    for (std::size_t at = 0; at < texels_.size(); ++at) {
        const std::size_t x = at % stride_, y = at / stride_ % stride_;
        if (x > 0 && x <= r && y > 0 && y <= r)
            continue;
        const auto inside = [&](std::size_t i) {
            return std::clamp((static_cast<double>(i) - 0.5) / r, -0.25 / r, 1.0 + 0.25 / r);
        };
        const FacePoint point =
            face_point(cube_point(AllFaces[at / (stride_ * stride_)], inside(x), inside(y)));
        const auto texel = [&](double s) {
            return std::min(static_cast<std::size_t>(s * r), std::size_t{r} - 1) + 1;
        };
        is_edge[at] =
            is_edge[(static_cast<std::size_t>(point.face) * stride_ + texel(point.t)) * stride_ +
                    texel(point.s)];
    }
    for (std::size_t at = 0; at < texels_.size(); ++at) {
        if (is_edge[at] == 0)
            continue;
        const std::size_t face = at / (stride_ * stride_), x = at % stride_,
                          y = at / stride_ % stride_;
        for (std::size_t v = std::max(y, std::size_t{1}) - 1; v < std::min(y + 2, stride_); ++v)
            for (std::size_t u = std::max(x, std::size_t{1}) - 1; u < std::min(x + 2, stride_); ++u)
                texels_[(face * stride_ + v) * stride_ + u].values[3] = 1.0f;
    }
}

/// Writes a row of a face, bilinear, and adds the columns near bright edges.
void QuickTurns::fill_row(Face face, std::uint32_t y, const glm::dmat3& source_from_destination,
                          glm::vec3* row, std::vector<std::uint32_t>& near_edges) const {
    const std::uint32_t r = map_->resolution;
    const double n = r;
    const double height = (y + 0.5) / n;
    // The centres of a row are evenly spaced on a line.
    const glm::dvec3 first = source_from_destination * cube_point(face, 0.5 / n, height);
    const glm::dvec3 step =
        (source_from_destination * cube_point(face, (r - 0.5) / n, height) - first) / (n - 1.0);
    const auto half = static_cast<float>(0.5 * n);
    std::uint32_t x = 0;
    while (x < r) {
        const Face from = face_point(first + step * static_cast<double>(x)).face;
        const FaceAxes axes(from);
        const glm::vec3 begin(axes.parts(first)), change(axes.parts(step));
        const Texel* texels = this->face(from);
        const std::uint32_t begin_x = x;
        for (; x < r; ++x) {
            const auto at = static_cast<float>(x);
            const float right = begin.x + at * change.x, down = begin.y + at * change.y,
                        outwards = begin.z + at * change.z;
            if (x > begin_x && !(std::max(std::abs(right), std::abs(down)) <= outwards))
                break;
            // In texels of the face with its border.
            const float scale = half / outwards;
            const float u = std::clamp(right * scale + half + 0.5f, 0.5f, 2.0f * half + 0.5f);
            const float v = std::clamp(down * scale + half + 0.5f, 0.5f, 2.0f * half + 0.5f);
            const auto column = static_cast<std::int32_t>(u), line = static_cast<std::int32_t>(v);
            const float fu = u - static_cast<float>(column), fv = v - static_cast<float>(line);
            const Texel* upper = texels + static_cast<std::size_t>(line) * stride_ +
                                 static_cast<std::size_t>(column);
            const Texel* lower = upper + stride_;
            Texel mean;
            for (std::size_t i = 0; i < 4; ++i) {
                const float above =
                    upper[0].values[i] + fu * (upper[1].values[i] - upper[0].values[i]);
                const float below =
                    lower[0].values[i] + fu * (lower[1].values[i] - lower[0].values[i]);
                mean.values[i] = above + fv * (below - above);
            }
            row[x] = {mean.values[0], mean.values[1], mean.values[2]};
            if (mean.values[3] > 0.0f)
                near_edges.push_back(x);
        }
    }
}

CubeMap QuickTurns::turned(const glm::dmat3& turn) const {
    if (carries_axes_to_axes(turn))
        return cubemap::turned(*map_, turn);
    const std::uint32_t r = map_->resolution;
    const glm::dmat3 source_from_destination = glm::transpose(turn);
    const TurnedTexels exact(*map_, source_from_destination);
    CubeMap result(r);
    // A row of tiles of a face, and what lies opposite of it.
    const auto fill_tiles = [&](Face face, std::uint32_t row, TurnedTile& sums) {
        const TexelRectangle first = exact.tile(face, row, 0);
        std::vector<std::uint32_t> near_edges;
        const auto fill = [&](Face filled, std::uint32_t y) {
            fill_row(filled, y, source_from_destination, &result.at(filled, 0, y), near_edges);
        };
        bool is_mirrored = false;
        for (std::uint32_t y = first.y0; y < first.y1; ++y) {
            const FacePoint opposite = face_point(-cube_point(face, 0.5 / r, (y + 0.5) / r));
            fill(opposite.face, static_cast<std::uint32_t>(opposite.t * r));
            is_mirrored = opposite.s > 0.5;
        }
        if (is_mirrored)
            for (std::uint32_t& x : near_edges)
                x = r - 1 - x;
        for (std::uint32_t y = first.y0; y < first.y1; ++y)
            fill(face, y);
        std::vector<bool> has_edge(exact.num_columns());
        for (const std::uint32_t x : near_edges)
            has_edge[exact.column_of(x)] = true;
        for (std::uint32_t column = 0; column < exact.num_columns(); ++column)
            if (has_edge[column])
                exact.fill(exact.tile(face, row, column), sums, result);
    };
    const std::size_t num_rows = exact.num_rows();
    files::parallel_for(files::IndexRange<std::size_t>(0, TurnedTexels::Faces.size() * num_rows),
                        [&](const auto& rows) {
                            TurnedTile sums;
                            for (std::size_t i = rows.begin(); i != rows.end(); ++i)
                                fill_tiles(TurnedTexels::Faces[i / num_rows],
                                           static_cast<std::uint32_t>(i % num_rows), sums);
                        });
    return result;
}

} // namespace relumine::cubemap
