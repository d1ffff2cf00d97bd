#include "tests/bench/baselines/cpca.h"

#include <algorithm>
#include <limits>

#include <Eigen/Dense>

#include "files/parallel.h"

namespace relumine::bench {

namespace {

constexpr std::size_t Lanes = 16;
constexpr int RoundsByDistance = 8, RoundsByError = 4;

using Rows = Eigen::Matrix<float, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;

Rows all_of(const BlockedRows& rows) {
    Rows all(rows.num_receivers, rows.num_columns);
    files::parallel_for(std::size_t{0}, rows.num_blocks(), [&](std::size_t block) {
        std::vector<float> values(rows.num_columns * Lanes);
        rows.read(block, values);
        const std::size_t first = block * Lanes;
        for (std::size_t lane = 0; lane < std::min(Lanes, rows.num_receivers - first); ++lane)
            for (std::size_t column = 0; column < rows.num_columns; ++column)
                all(static_cast<Eigen::Index>(first + lane), static_cast<Eigen::Index>(column)) =
                    values[column * Lanes + lane];
    });
    return all;
}

/// A cluster's subspace.
struct Subspace {
    Eigen::RowVectorXf mean;
    /// [components x columns], orthonormal
    Rows axes;
};

/// The principal axes of rows, by the smaller of the two matrices of products.
Subspace subspace_of(const Rows& rows, Eigen::Index num_components) {
    Subspace result{.mean = rows.colwise().mean(), .axes = {}};
    const Rows centred = rows.rowwise() - result.mean;
    const bool is_wide = rows.rows() < rows.cols();
    const Eigen::MatrixXf products = is_wide ? Eigen::MatrixXf(centred * centred.transpose())
                                             : Eigen::MatrixXf(centred.transpose() * centred);
    const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXf> solver(products);
    const Eigen::Index kept = std::min(num_components, products.rows());
    result.axes.setZero(num_components, rows.cols());
    for (Eigen::Index i = 0; i < kept; ++i) {
        const Eigen::VectorXf vector = solver.eigenvectors().col(products.rows() - 1 - i);
        Eigen::RowVectorXf axis = is_wide ? Eigen::RowVectorXf(vector.transpose() * centred)
                                          : Eigen::RowVectorXf(vector.transpose());
        const float length = axis.norm();
        if (length > 0.0f)
            result.axes.row(i) = axis / length;
    }
    return result;
}

/// Which cluster describes each row with the least squared error.
std::vector<std::size_t> nearest(const Rows& all, const std::vector<Subspace>& clusters) {
    std::vector<std::size_t> result(static_cast<std::size_t>(all.rows()));
    constexpr std::size_t Step = 256;
    files::parallel_for(std::size_t{0}, (result.size() + Step - 1) / Step, [&](std::size_t part) {
        const auto first = static_cast<Eigen::Index>(part * Step);
        const Eigen::Index count = std::min<Eigen::Index>(Eigen::Index{Step}, all.rows() - first);
        Eigen::VectorXf least = Eigen::VectorXf::Constant(count, std::numeric_limits<float>::max());
        for (std::size_t c = 0; c < clusters.size(); ++c) {
            const Rows centred = all.middleRows(first, count).rowwise() - clusters[c].mean;
            Eigen::VectorXf error = centred.rowwise().squaredNorm();
            if (clusters[c].axes.rows() != 0)
                error -= (centred * clusters[c].axes.transpose()).rowwise().squaredNorm();
            for (Eigen::Index i = 0; i < count; ++i)
                if (error[i] < least[i]) {
                    least[i] = error[i];
                    result[static_cast<std::size_t>(first + i)] = c;
                }
        }
    });
    return result;
}

/// The rows of each cluster.
std::vector<std::vector<std::uint32_t>> members(const std::vector<std::size_t>& of_row,
                                                std::size_t num_clusters) {
    std::vector<std::vector<std::uint32_t>> result(num_clusters);
    for (std::size_t i = 0; i < of_row.size(); ++i)
        result[of_row[i]].push_back(static_cast<std::uint32_t>(i));
    return result;
}

Rows rows_of(const Rows& all, const std::vector<std::uint32_t>& chosen) {
    Rows rows(static_cast<Eigen::Index>(chosen.size()), all.cols());
    for (std::size_t i = 0; i < chosen.size(); ++i)
        rows.row(static_cast<Eigen::Index>(i)) = all.row(chosen[i]);
    return rows;
}

std::vector<Subspace> fitted(const Rows& all, std::size_t num_clusters,
                             std::size_t num_components) {
    // Rows stand in spatial order, so evenly spaced ones are spread over the surface.
    std::vector<Subspace> clusters(num_clusters);
    for (std::size_t c = 0; c < num_clusters; ++c)
        clusters[c].mean = all.row(static_cast<Eigen::Index>(
            (2 * c + 1) * static_cast<std::size_t>(all.rows()) / (2 * num_clusters)));
    for (int round = 0; round < RoundsByDistance + RoundsByError; ++round) {
        const auto own = members(nearest(all, clusters), num_clusters);
        const bool with_axes = round + 1 >= RoundsByDistance;
        files::parallel_for(std::size_t{0}, num_clusters, [&](std::size_t c) {
            if (own[c].empty())
                return;
            const Rows rows = rows_of(all, own[c]);
            if (with_axes)
                clusters[c] = subspace_of(rows, static_cast<Eigen::Index>(num_components));
            else
                clusters[c].mean = rows.colwise().mean();
        });
    }
    return clusters;
}

} // namespace

ClusteredComponents::ClusteredComponents(const BlockedRows& rows, std::size_t num_clusters,
                                         std::size_t num_components)
    : num_receivers_(rows.num_receivers), num_columns_(rows.num_columns) {
    const Rows all = all_of(rows);
    const std::vector<Subspace> subspaces = fitted(all, num_clusters, num_components);
    const auto own = members(nearest(all, subspaces), num_clusters);
    for (std::size_t c = 0; c < num_clusters; ++c) {
        if (own[c].empty())
            continue;
        const Subspace& subspace = subspaces[c];
        Cluster cluster{.receivers = own[c]};
        cluster.vectors.assign(subspace.mean.begin(), subspace.mean.end());
        cluster.vectors.insert(cluster.vectors.end(), subspace.axes.data(),
                               subspace.axes.data() + subspace.axes.size());
        const Rows weights =
            (rows_of(all, own[c]).rowwise() - subspace.mean) * subspace.axes.transpose();
        cluster.weights = packed<std::int16_t>(
            {.num_receivers = own[c].size(),
             .num_columns = num_components + 1,
             .read = [&](std::size_t block, std::span<float> values) {
                 std::ranges::fill(values, 0.0f);
                 const std::size_t first = block * Lanes;
                 for (std::size_t i = first; i < std::min(first + Lanes, own[c].size()); ++i) {
                     values[i - first] = 1.0f;
                     for (std::size_t k = 0; k < num_components; ++k)
                         values[(k + 1) * Lanes + i - first] =
                             weights(static_cast<Eigen::Index>(i), static_cast<Eigen::Index>(k));
                 }
             }});
        clusters_.push_back(std::move(cluster));
    }
}

std::size_t ClusteredComponents::bytes() const {
    std::size_t sum = 0;
    for (const Cluster& cluster : clusters_)
        sum += cluster.receivers.size() * sizeof(std::uint32_t) +
               cluster.vectors.size() * sizeof(float) + cluster.weights.bytes();
    return sum;
}

std::vector<std::byte> ClusteredComponents::content() const {
    std::vector<std::byte> bytes;
    const auto add = [&](const auto& values) {
        const auto more = std::as_bytes(std::span(values));
        bytes.insert(bytes.end(), more.begin(), more.end());
    };
    for (const Cluster& cluster : clusters_) {
        add(cluster.receivers);
        add(cluster.vectors);
        add(cluster.weights.scales);
        add(cluster.weights.values);
    }
    return bytes;
}

void ClusteredComponents::multiply(std::span<const glm::vec3> light,
                                   std::vector<glm::vec3>& radiance) const {
    radiance.resize(num_receivers_);
    files::parallel_for(std::size_t{0}, clusters_.size(), [&](std::size_t c) {
        const Cluster& cluster = clusters_[c];
        std::vector<glm::vec3> of_vectors(cluster.weights.num_columns, glm::vec3(0.0f)), own;
        for (std::size_t i = 0; i < cluster.vectors.size(); ++i)
            of_vectors[i / num_columns_] += cluster.vectors[i] * light[i % num_columns_];
        bench::multiply(cluster.weights, of_vectors, own);
        for (std::size_t i = 0; i < own.size(); ++i)
            radiance[cluster.receivers[i]] = own[i];
    });
}

} // namespace relumine::bench
