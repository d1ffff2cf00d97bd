#include "files/jpeg_decoder.h"

#include <csetjmp>
#include <cstdio> // jpeglib.h needs it
#include <stdexcept>
#include <vector>

#include <fmt/format.h>
#include <jerror.h>
#include <jpeglib.h>

namespace relumine::files {

namespace {

constexpr int MaxScans = 100; // programs write about ten

/// libjpeg leaves through longjmp on errors. So functions that it may leave hold no object with a
/// destructor.
class Decoder {
public:
    explicit Decoder(std::span<const std::byte> file) {
        info_.err = jpeg_std_error(&errors_);
        info_.client_data = this;
        errors_.error_exit = [](j_common_ptr info) {
            decoder(info).leave();
        };
        errors_.emit_message = [](j_common_ptr info, int level) {
            // Level -1 means broken data that libjpeg would repair by guessing. Stray bytes between
            // segments do no harm.
            if (level < 0 && info->err->msg_code != JWRN_EXTRANEOUS_DATA)
                decoder(info).leave();
        };
        jpeg_create_decompress(&info_);
        progress_.progress_monitor = [](j_common_ptr info) {
            if (reinterpret_cast<j_decompress_ptr>(info)->input_scan_number > MaxScans)
                decoder(info).leave();
        };
        info_.progress = &progress_;
        jpeg_mem_src(&info_, reinterpret_cast<const unsigned char*>(file.data()), file.size());
    }
    ~Decoder() { jpeg_destroy_decompress(&info_); }
    Decoder(const Decoder&) = delete;
    Decoder& operator=(const Decoder&) = delete;

    /// Reads the header, which has the size.
    bool read_header() {
        if (setjmp(errors_jump_) != 0)
            return false;
        jpeg_read_header(&info_, TRUE);
        is_cmyk_ = info_.jpeg_color_space == JCS_CMYK || info_.jpeg_color_space == JCS_YCCK;
        info_.out_color_space = is_cmyk_ ? JCS_CMYK : JCS_RGB;
        return true;
    }

    bool read_pixels(std::uint8_t* rgb) {
        row_.resize(is_cmyk_ ? std::size_t{info_.image_width} * 4 : 0);
        return read_rows(rgb);
    }

    [[nodiscard]] std::uint32_t width() const { return info_.image_width; }
    [[nodiscard]] std::uint32_t height() const { return info_.image_height; }
    [[nodiscard]] const char* message() const { return message_; }

private:
    static Decoder& decoder(j_common_ptr info) { return *static_cast<Decoder*>(info->client_data); }

    [[noreturn]] void leave() {
        if (info_.input_scan_number > MaxScans)
            std::snprintf(message_, sizeof message_, "more than %d scans", MaxScans);
        else
            errors_.format_message(reinterpret_cast<j_common_ptr>(&info_), message_);
        std::longjmp(errors_jump_, 1);
    }

    bool read_rows(std::uint8_t* rgb) {
        if (setjmp(errors_jump_) != 0)
            return false;
        jpeg_start_decompress(&info_);
        while (info_.output_scanline < info_.output_height) {
            std::uint8_t* target =
                rgb + std::size_t{info_.output_scanline} * info_.output_width * 3;
            JSAMPROW row = is_cmyk_ ? row_.data() : target;
            jpeg_read_scanlines(&info_, &row, 1);
            for (std::size_t x = 0; is_cmyk_ && x < info_.output_width; ++x)
                for (std::size_t channel = 0; channel < 3; ++channel)
                    target[3 * x + channel] =
                        static_cast<std::uint8_t>(row_[4 * x + channel] * row_[4 * x + 3] / 255);
        }
        jpeg_finish_decompress(&info_);
        return true;
    }

    jpeg_decompress_struct info_{};
    jpeg_error_mgr errors_{};
    jpeg_progress_mgr progress_{};
    std::jmp_buf errors_jump_{};
    char message_[JMSG_LENGTH_MAX] = "";
    bool is_cmyk_ = false;
    std::vector<std::uint8_t> row_;
};

} // namespace

void decode_jpeg(std::span<const std::byte> file,
                 const std::function<std::uint8_t*(std::uint32_t, std::uint32_t)>& allocate) {
    Decoder decoder(file);
    if (!decoder.read_header())
        throw std::runtime_error(
            fmt::format("expected a JPEG image, got broken data ({})", decoder.message()));
    if (!decoder.read_pixels(allocate(decoder.width(), decoder.height())))
        throw std::runtime_error(
            fmt::format("expected a whole image of {} x {} pixels, got broken data ({})",
                        decoder.width(), decoder.height(), decoder.message()));
}

} // namespace relumine::files
