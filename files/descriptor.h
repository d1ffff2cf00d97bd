// A POSIX file descriptor with an owner.
#pragma once

namespace relumine::files {

/// A file descriptor that closes itself; negative: none.
class Descriptor {
public:
    explicit Descriptor(int descriptor = -1) : fd_(descriptor) {}
    ~Descriptor();
    Descriptor(Descriptor&& other) noexcept;
    Descriptor& operator=(Descriptor&& other) noexcept;

    [[nodiscard]] int get() const { return fd_; }
    [[nodiscard]] bool is_open() const { return fd_ >= 0; }

private:
    int fd_;
};

} // namespace relumine::files
