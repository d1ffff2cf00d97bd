// Curves are cubic Hermite splines over uneven times. The slope at a key is that of the parabola
// through the key and its neighbours, as of Catmull and Rom, "A class of local interpolating
// splines", 1974, for even times. It is at most three times the slope to either neighbour: de Boor
// and Swartz, "Piecewise monotone interpolation", 1977.
#include "relumine/out/camera_path.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <span>
#include <stdexcept>
#include <string_view>

#include <fmt/format.h>
#include <glm/geometric.hpp>

#include "files/json_reader.h"
#include "files/output_file.h"
#include "relumine/options/option_table.h"

namespace relumine {

namespace {

constexpr double Version = 1.0;
constexpr double SmallestFov = 0.01, LargestFov = 179.0;

class CameraPathReader {
public:
    explicit CameraPathReader(const files::JsonReader& json) : json_(json) {}

    CameraPath read(const std::filesystem::path& path) const {
        const files::Json root = json_.parse(files::read(path));
        json_.known(root, std::array<std::string_view, 2>{"version", "frames"}, "a camera path");
        json_.require_version(root, Version);
        const files::Json& frames = json_.required(root, "frames");
        CameraPath result;
        for (const files::Json& value : json_.array(frames, "\"frames\""))
            add_key(value, result);
        if (result.keys.size() < 2)
            json_.refuse(frames, "at least 2 key frames", fmt::format("{}", result.keys.size()));
        return result;
    }

private:
    void add_key(const files::Json& value, CameraPath& path) const {
        json_.known(value, std::array<std::string_view, 4>{"frame", "eye", "target", "fov_degrees"},
                    "a key frame");
        CameraKey key;
        key.frame = frame(json_.required(value, "frame"), path);
        key.camera.eye = point(json_.required(value, "eye"), "\"eye\"");
        const files::Json& target = json_.required(value, "target");
        key.camera.target = point(target, "\"target\"");
        if (!has_direction(key.camera))
            json_.refuse(target, "a target other than the eye", "the same point");
        if (const files::Json* fov = value.find("fov_degrees")) {
            if (!path.keys.empty() && !path.names_fov)
                json_.refuse(*fov, "\"fov_degrees\" at the first key frame, too", "none there");
            path.names_fov = true;
            key.camera.fov_degrees = fov_degrees(*fov);
        } else if (!path.keys.empty()) {
            key.camera.fov_degrees = path.keys.back().camera.fov_degrees;
        }
        path.keys.push_back(key);
    }

    double frame(const files::Json& value, const CameraPath& before) const {
        const double result = json_.number(value, "\"frame\"");
        if (!(result >= 0.0 && result <= LastCameraFrame))
            json_.refuse(value, fmt::format("\"frame\" from 0 to {}", LastCameraFrame),
                         fmt::format("{}", result));
        if (!before.keys.empty() && !(result > before.keys.back().frame))
            json_.refuse(value, fmt::format("a frame after {}", before.keys.back().frame),
                         fmt::format("{}", result));
        return result;
    }

    glm::dvec3 point(const files::Json& value, std::string_view what) const {
        const glm::dvec3 result = json_.vector(value, what);
        for (int axis = 0; axis < 3; ++axis)
            if (!(std::abs(result[axis]) <= LargestPosition))
                json_.refuse(value, fmt::format("{} within {}", what, LargestPosition),
                             fmt::format("{}", result[axis]));
        return result;
    }

    float fov_degrees(const files::Json& value) const {
        const double result = json_.number(value, "\"fov_degrees\"");
        if (!(result >= SmallestFov && result <= LargestFov))
            json_.refuse(value,
                         fmt::format("\"fov_degrees\" from {} to {}", SmallestFov, LargestFov),
                         fmt::format("{}", result));
        return static_cast<float>(result);
    }

    const files::JsonReader& json_;
};

double length_of(double value) {
    return std::abs(value);
}
double length_of(const glm::dvec3& value) {
    return glm::length(value);
}

/// Whether a key is the end of a way there and back, where a number must not go farther.
bool turns_back(double before, double after) {
    return before * after < 0.0;
}
/// Points may swing wide: a camera that goes around a corner must not stop there.
bool turns_back(const glm::dvec3&, const glm::dvec3&) {
    return false;
}

/// The values of all keys, and when.
template<typename Value>
struct Curve {
    std::span<const CameraKey> keys;
    Value (*value_of)(const PlacedCamera&);

    [[nodiscard]] Value value(std::size_t key) const { return value_of(keys[key].camera); }
    [[nodiscard]] double duration(std::size_t key) const {
        return keys[key + 1].frame - keys[key].frame;
    }
    /// The mean change per frame from a key to the next.
    [[nodiscard]] Value change(std::size_t key) const {
        return (value(key + 1) - value(key)) / duration(key);
    }

    /// The change per frame at a key: none at both ends, and none where the value rests.
    [[nodiscard]] Value slope(std::size_t key) const {
        if (key == 0 || key + 1 == keys.size())
            return Value(0.0);
        const Value before = change(key - 1), after = change(key);
        const double most = 3.0 * std::min(length_of(before), length_of(after));
        if (most == 0.0 || turns_back(before, after))
            return Value(0.0);
        const double time_before = duration(key - 1), time_after = duration(key);
        const Value parabola =
            (before * time_after + after * time_before) / (time_before + time_after);
        const double length = length_of(parabola);
        return length > most ? parabola * (most / length) : parabola;
    }

    /// The value in the interval that begins at a key, t in [0, 1].
    [[nodiscard]] Value at(std::size_t key, double t) const {
        const double t2 = t * t, t3 = t2 * t, time = duration(key);
        return value(key) * (2.0 * t3 - 3.0 * t2 + 1.0) +
               slope(key) * (time * (t3 - 2.0 * t2 + t)) + value(key + 1) * (3.0 * t2 - 2.0 * t3) +
               slope(key + 1) * (time * (t3 - t2));
    }
};

glm::dvec3 eye_of(const PlacedCamera& camera) {
    return camera.eye;
}
glm::dvec3 target_of(const PlacedCamera& camera) {
    return camera.target;
}
double fov_of(const PlacedCamera& camera) {
    return camera.fov_degrees;
}

} // namespace

std::size_t CameraPath::num_frames() const {
    return keys.empty() ? 0 : static_cast<std::size_t>(std::floor(keys.back().frame)) + 1;
}

CameraPath load_camera_path(const std::filesystem::path& path) {
    const files::JsonReader json(path.string());
    return CameraPathReader(json).read(path);
}

PlacedCamera camera_at(const CameraPath& path, double frame) {
    const std::span<const CameraKey> keys = path.keys;
    if (keys.empty())
        throw std::invalid_argument("expected a camera path with keys, got none");
    const auto after = std::find_if(keys.begin(), keys.end(),
                                    [&](const CameraKey& key) { return key.frame > frame; });
    if (after == keys.begin())
        return keys.front().camera;
    if (after == keys.end())
        return keys.back().camera;
    const auto key = static_cast<std::size_t>(after - keys.begin()) - 1;
    const double t = (frame - keys[key].frame) / (keys[key + 1].frame - keys[key].frame);
    // Rounding must not carry the field of view out of the range of its keys.
    const auto [least, most] =
        std::minmax({keys[key].camera.fov_degrees, keys[key + 1].camera.fov_degrees});
    PlacedCamera result;
    result.eye = Curve<glm::dvec3>{keys, eye_of}.at(key, t);
    result.target = Curve<glm::dvec3>{keys, target_of}.at(key, t);
    result.fov_degrees =
        std::clamp(static_cast<float>(Curve<double>{keys, fov_of}.at(key, t)), least, most);
    return result;
}

bool has_direction(const PlacedCamera& camera) {
    constexpr double Rounding = 1e-14;
    return glm::distance(camera.eye, camera.target) >
           Rounding * std::max(glm::length(camera.eye), glm::length(camera.target));
}

} // namespace relumine
