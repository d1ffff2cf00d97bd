// Based on: J. R. Shewchuk, "Adaptive Precision Floating-Point Arithmetic and Fast Robust Geometric
// Predicates", 1997.
#include "mesh/exact_sign.h"

#include <array>
#include <cmath>
#include <cstddef>

namespace relumine::mesh {

namespace {

/// An exact sum of doubles: components that do not overlap, from small to large (Shewchuk,
/// GROW-EXPANSION).
class ExactSum {
public:
    void add(double term) {
        std::size_t kept = 0;
        for (std::size_t i = 0; i < size_; ++i) {
            // Knuth's sum: the rounded sum and its rounding error.
            const double sum = term + components_[i];
            const double other = sum - term;
            const double lost = (term - (sum - other)) + (components_[i] - other);
            if (lost != 0.0)
                components_[kept++] = lost;
            term = sum;
        }
        if (term != 0.0)
            components_[kept++] = term;
        size_ = kept;
    }
    /// The largest component exceeds all others together, so its sign is the sum's.
    [[nodiscard]] int sign() const {
        return size_ == 0 ? 0 : components_[size_ - 1] > 0.0 ? 1 : -1;
    }

private:
    std::array<double, 64> components_{};
    std::size_t size_ = 0;
};

/// Returns the product of two floats, which is exact in double.
double product(float a, float b) {
    return static_cast<double>(a) * static_cast<double>(b);
}

} // namespace

int turn(const glm::vec2& a, const glm::vec2& b, const glm::vec2& c) {
    ExactSum sum; // (b - a) x (c - a), multiplied out
    sum.add(product(b.x, c.y));
    sum.add(-product(b.y, c.x));
    sum.add(-product(b.x, a.y));
    sum.add(product(b.y, a.x));
    sum.add(-product(a.x, c.y));
    sum.add(product(a.y, c.x));
    return sum.sign();
}

bool coplanar(const glm::vec3& a, const glm::vec3& b, const glm::vec3& c, const glm::vec3& d) {
    for (int axis = 0; axis < 3; ++axis)
        if (a[axis] == b[axis] && a[axis] == c[axis] && a[axis] == d[axis])
            return true;
    // In double the differences have an error of 2^-53, their triple products less than 16 times as
    // much. Most points are clearly out of plane.
    const glm::dvec3 ab = glm::dvec3(b) - glm::dvec3(a);
    const glm::dvec3 ac = glm::dvec3(c) - glm::dvec3(a);
    const glm::dvec3 ad = glm::dvec3(d) - glm::dvec3(a);
    const auto volume = [](const glm::dvec3& p, const glm::dvec3& q, const glm::dvec3& r,
                           double sign) {
        return p.x * (q.y * r.z + sign * q.z * r.y) + p.y * (q.z * r.x + sign * q.x * r.z) +
               p.z * (q.x * r.y + sign * q.y * r.x);
    };
    if (std::abs(volume(ab, ac, ad, -1.0)) >
        1e-14 * volume(glm::abs(ab), glm::abs(ac), glm::abs(ad), 1.0))
        return false;

    // The determinant of the points with a column of ones: the signed triple products of each three
    // points.
    ExactSum sum;
    const auto add_product = [&](float p, float q, float r, double sign) {
        const double pq = product(p, q);
        const double pqr = pq * static_cast<double>(r);
        sum.add(sign * pqr);
        sum.add(sign * std::fma(pq, static_cast<double>(r), -pqr));
    };
    const auto add_determinant = [&](const glm::vec3& p, const glm::vec3& q, const glm::vec3& r,
                                     double sign) {
        for (int i = 0; i < 3; ++i) {
            add_product(p[i], q[(i + 1) % 3], r[(i + 2) % 3], sign);
            add_product(p[i], q[(i + 2) % 3], r[(i + 1) % 3], -sign);
        }
    };
    add_determinant(b, c, d, 1.0);
    add_determinant(a, c, d, -1.0);
    add_determinant(a, b, d, 1.0);
    add_determinant(a, b, c, -1.0);
    return sum.sign() == 0;
}

} // namespace relumine::mesh
