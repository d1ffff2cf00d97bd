// Images and folders that the cubemap tests share.
#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <random>
#include <string>
#include <vector>

#include <glm/vec3.hpp>
#include <gtest/gtest.h>

#include "cubemap/cube_map.h"
#include "cubemap/image/environment.h"
#include "cubemap/image/image_layout.h"
#include "tests/own_folder.h"
#include "tests/real_data.h"

namespace relumine::cubemap {

inline EnvironmentImage black_image(Layout layout, Sampling sampling, std::uint32_t width,
                                    std::uint32_t height) {
    EnvironmentImage image;
    image.layout = layout;
    image.sampling = sampling;
    image.width = width;
    image.height = height;
    image.pixels.assign(static_cast<std::size_t>(width) * height, glm::vec3(0.0f));
    return image;
}

/// An image of the layout whose height is `size` (LatLong), whose faces are `size`, or whose side
/// is (squares).
inline EnvironmentImage black_image(Layout layout, Sampling sampling, std::uint32_t size) {
    if (layout == Layout::LatLong)
        return black_image(layout, sampling, 2 * size, size);
    if (!has_faces(layout))
        return black_image(layout, sampling, size, size);
    const ImageSize pixels = natural_size(layout, size);
    return black_image(layout, sampling, pixels.width, pixels.height);
}

/// Sets every pixel from the direction it stands for.
inline void paint(EnvironmentImage& image,
                  const std::function<glm::vec3(const glm::dvec3&)>& radiance) {
    for_each_pixel(shape_of(image), [&](std::size_t index, const PixelPlace& place) {
        image.pixels[index] = radiance(place.direction);
    });
}

inline void fill_randomly(std::vector<glm::vec3>& pixels, std::uint32_t seed) {
    std::mt19937 generator(seed);
    std::uniform_real_distribution<float> uniform(0.0f, 1.0f);
    for (glm::vec3& pixel : pixels)
        pixel = {uniform(generator), uniform(generator), uniform(generator)};
}

inline glm::dvec3 total_power(const EnvironmentImage& image) {
    glm::dvec3 sum(0.0);
    for_each_pixel(shape_of(image), [&](std::size_t index, const PixelPlace& place) {
        sum += glm::dvec3(image.pixels[index]) * place.solid_angle;
    });
    return sum;
}

/// A folder of the test's own that goes with it.
class TemporaryFolder {
public:
    TemporaryFolder() : path_(tests::folder_of_test()) {
        std::filesystem::remove_all(path_);
        std::filesystem::create_directories(path_);
    }
    ~TemporaryFolder() { std::filesystem::remove_all(path_); }
    TemporaryFolder(const TemporaryFolder&) = delete;
    TemporaryFolder& operator=(const TemporaryFolder&) = delete;
    [[nodiscard]] std::filesystem::path operator/(const std::string& name) const {
        return path_ / name;
    }
    [[nodiscard]] std::size_t num_files() const {
        return static_cast<std::size_t>(std::distance(std::filesystem::directory_iterator(path_),
                                                      std::filesystem::directory_iterator()));
    }

private:
    std::filesystem::path path_;
};

using tests::message_of;

/// A file of the data folder, or empty where that is absent.
inline std::filesystem::path data_file(const std::string& name) {
    return real_data(std::filesystem::path("envs") / name);
}

} // namespace relumine::cubemap
