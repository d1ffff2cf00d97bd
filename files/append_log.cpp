#include "files/append_log.h"

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <utility>

#include <fcntl.h>
#include <unistd.h>

#include "files/hash.h"
#include "files/output_file.h"

namespace relumine::files {

namespace {

constexpr std::uint64_t Mark = 0x64726f6365525052; // "RPRecord"

struct Head {
    std::uint64_t mark = Mark;
    std::uint64_t size = 0;
    std::uint64_t checksum = 0;
};

} // namespace

AppendLog::AppendLog(std::filesystem::path path) : path_(std::move(path)) {}

std::vector<std::vector<std::byte>> AppendLog::read(std::optional<std::uint64_t> max_bytes) {
    std::vector<std::vector<std::byte>> records;
    size_ = 0;
    if (!std::filesystem::exists(path_))
        return records;
    const std::vector<std::byte> bytes = files::read(path_);
    const std::uint64_t end =
        std::min<std::uint64_t>(bytes.size(), max_bytes.value_or(bytes.size()));
    Head head;
    while (end - size_ >= sizeof head) {
        std::memcpy(&head, bytes.data() + size_, sizeof head);
        const std::uint64_t begin = size_ + sizeof head;
        if (head.mark != Mark || head.size > end - begin)
            break;
        const std::span<const std::byte> record = std::span(bytes).subspan(begin, head.size);
        if (hash_of(record) != head.checksum)
            break;
        records.emplace_back(record.begin(), record.end());
        size_ = begin + head.size;
    }
    return records;
}

void AppendLog::open() {
    if (file_.is_open())
        return;
    file_ = Descriptor(::open(path_.c_str(), O_WRONLY | O_CREAT | O_CLOEXEC, 0666));
    if (!file_.is_open())
        fail(path_, "write", errno);
}

void AppendLog::append(std::span<const std::byte> record) {
    open();
    const Head head{.size = record.size(), .checksum = hash_of(record)};
    const std::uint64_t needed = sizeof head + record.size();
    // Bytes behind the last record come from a run that was killed.
    if (::ftruncate(file_.get(), static_cast<off_t>(size_)) != 0)
        fail(path_, "write", errno);
    write_at(path_, file_.get(), size_, std::as_bytes(std::span(&head, 1)), needed, size_);
    write_at(path_, file_.get(), size_ + sizeof head, record, needed, size_);
    if (::fdatasync(file_.get()) != 0) {
        const int error = errno;
        static_cast<void>(::ftruncate(file_.get(), static_cast<off_t>(size_)) == 0);
        fail_to_write(path_, error, needed, file_.get());
    }
    size_ += sizeof head + record.size();
}

} // namespace relumine::files
