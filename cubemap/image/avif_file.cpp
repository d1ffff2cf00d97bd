// AVIF whose numbers are light above white: PQ or HLG, as Lightroom, Photoshop and cameras write
// it. Based on: Alliance for Open Media, "AV1 Image File Format" 1.1; code points of ITU-T H.273.
#include <array>
#include <limits>
#include <mutex>
#include <optional>
#include <stdexcept>

#include <fmt/format.h>

#include "cubemap/image/image_file.h"
#include "files/avif_decoder.h"

namespace relumine::cubemap {

bool is_avif(std::span<const std::byte> bytes) {
    return files::is_avif(bytes);
}

#ifdef RELUMINE_HDR_PHOTOS

namespace {

class AvifRows : public ImageRows {
public:
    explicit AvifRows(FileBytes file)
        : file_(std::move(file)), bytes_(file_.read(0, file_.size())) {
        constexpr std::uint32_t MostEdge = 65536;
        named([&] { picture_.emplace(bytes_); });
        const files::AvifPicture::Head& image = picture_->head();
        if (image.width > MostEdge || image.height > MostEdge)
            file_.refuse(fmt::format("edges of up to {} pixels", MostEdge),
                         fmt::format("{}x{}", image.width, image.height));
        constexpr std::uint64_t MostPixelsPerByte = 20'000; // one colour takes hardly any
        file_.check_size(image.width, image.height, MostPixelsPerByte);
        if (image.transfer != image.Pq && image.transfer != image.Hlg)
            file_.refuse("an AVIF by PQ or HLG",
                         fmt::format("the transfer {} of H.273, which holds no light above white",
                                     image.transfer));
        const std::array<float, 8>& xy = image.primaries;
        colors_.emplace(*space_of({{xy[0], xy[1]}, {xy[2], xy[3]}, {xy[4], xy[5]}, {xy[6], xy[7]}},
                                  image.transfer == image.Pq ? Transfer::Pq : Transfer::Hlg));
        head_.width = image.width;
        head_.height = image.height;
        head_.remarks.push_back(
            fmt::format("{} bits; a display's white of 203 cd/m2 is 1", image.num_bits));
        if (image.is_turned)
            head_.remarks.emplace_back("its turn or mirror is not done");
    }

    [[nodiscard]] std::uint32_t rows_together() const override { return head_.height; }

    Counts read(std::uint32_t first, std::span<glm::vec3> pixels) const override {
        std::call_once(is_decoded_, [&] { decode(); });
        const bool has_alpha = picture_->head().has_alpha;
        const std::size_t num_channels = has_alpha ? 4 : 3;
        const std::uint16_t* value = &numbers_[std::size_t{first} * head_.width * num_channels];
        constexpr float Most = std::numeric_limits<std::uint16_t>::max();
        for (glm::vec3& pixel : pixels) {
            pixel = glm::vec3(value[0], value[1], value[2]) / Most;
            value += num_channels;
        }
        Counts counts{.num_outside = colors_->convert(pixels)};
        if (has_alpha) {
            const std::uint16_t* alpha = &numbers_[std::size_t{first} * head_.width * 4 + 3];
            for (std::size_t i = 0; i < pixels.size(); ++i) {
                pixels[i] *= alpha[4 * i] / Most;
                counts.num_transparent += alpha[4 * i] == 0 ? 1 : 0;
            }
        }
        return counts;
    }

private:
    /// Names the file where the decoder refuses it.
    template<typename Work>
    void named(const Work& work) const {
        try {
            work();
        } catch (const std::runtime_error& error) {
            throw std::runtime_error(file_.name() + ": " + error.what());
        }
    }
    /// 16 bits for each channel
    void decode() const {
        const files::AvifPicture::Head& image = picture_->head();
        numbers_.resize(std::size_t{image.width} * image.height * (image.has_alpha ? 4 : 3));
        named([&] { picture_->decode(std::span(numbers_), image.has_alpha); });
    }

    FileBytes file_;
    std::vector<std::byte> bytes_;
    std::optional<files::AvifPicture> picture_;
    mutable std::once_flag is_decoded_;
    mutable std::vector<std::uint16_t> numbers_;
};

} // namespace

std::unique_ptr<ImageRows> open_avif(FileBytes file) {
    return std::make_unique<AvifRows>(std::move(file));
}

#endif

} // namespace relumine::cubemap
