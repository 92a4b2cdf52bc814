#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <atomic>
#include <cerrno>
#include <cstring>
#include <filesystem>

#include "engine/error.h"
#include "engine/image/atomic_file.h"
#include "engine/image/image.h"

namespace radivox::image {

namespace fs = std::filesystem;

namespace {

[[noreturn]] void fail(const std::string& path, const std::string& why) {
  throw Error(ErrorCode::BadInput, "cannot write '" + path + "': " + why);
}

std::string mendFor(int error, const fs::path& folder) {
  const std::string where = "folder '" + folder.string() + "'";
  switch (error) {
    case ENOENT:
      return where + " does not exist; create it or choose another";
    case ENOTDIR:
      return "'" + folder.string() + "' is not a folder; choose another";
    case EACCES:
    case EPERM:
    case EROFS:
      return where + " is not writable (" + std::strerror(error) + "); choose another";
    case ENOSPC:
    case EDQUOT:
      return std::string(std::strerror(error)) + "; free some space or choose another folder";
    case EFBIG:
      return "the file would exceed the file size limit; raise it or choose a smaller image";
    default:
      return std::strerror(error);
  }
}

struct Target {
  fs::path file;    ///< links followed
  fs::path folder;  ///< where the temporary name goes
  mode_t mode = 0;  ///< of the file to be replaced; 0: there is none
};

Target findTarget(const std::string& path) {
  if (path.empty()) fail(path, "the file name is empty; give one");
  Target target;
  target.file = path;
  std::error_code error;
  if (fs::is_symlink(target.file, error)) {
    const fs::path resolved = fs::weakly_canonical(target.file, error);
    if (error) fail(path, "the link cannot be followed (" + error.message() + ")");
    target.file = resolved;
  }
  target.folder = target.file.has_parent_path() ? target.file.parent_path() : fs::path(".");
  struct stat info {};
  if (::stat(target.file.c_str(), &info) == 0) {
    if (S_ISDIR(info.st_mode)) fail(path, "it is a folder; add a file name");
    // Renaming over a device or a pipe would put a file in its place.
    if (!S_ISREG(info.st_mode)) fail(path, "it is not a regular file; choose another name");
    target.mode = info.st_mode & 07777;
  }
  if (target.file.filename().empty()) fail(path, "it is a folder; add a file name");
  return target;
}

/// A file that vanishes unless it is committed.
class TemporaryFile {
 public:
  explicit TemporaryFile(const Target& target, const std::string& shown) : shown_(shown), folder_(target.folder) {
    static std::atomic<uint32_t> serial{0};
    // Short and independent of the name asked for, which may be as long as the file system allows.
    do {
      name_ = target.folder / (".radivox-" + std::to_string(::getpid()) + "-" + std::to_string(serial++) + ".tmp");
      descriptor_ = ::open(name_.c_str(), O_WRONLY | O_CREAT | O_EXCL | O_CLOEXEC, 0666);
    } while (descriptor_ < 0 && (errno == EEXIST || errno == EINTR));
    if (descriptor_ < 0) fail(shown_, mendFor(errno, folder_));
    if (target.mode != 0) (void)::fchmod(descriptor_, target.mode);
  }
  TemporaryFile(const TemporaryFile&) = delete;
  TemporaryFile& operator=(const TemporaryFile&) = delete;
  ~TemporaryFile() {
    if (descriptor_ >= 0) ::close(descriptor_);
    if (!name_.empty()) ::unlink(name_.c_str());
  }

  void write(const char* bytes, size_t count) {
    size_t done = 0;
    while (done < count) {
      const ssize_t n = ::write(descriptor_, bytes + done, count - done);
      if (n < 0 && errno == EINTR) continue;
      if (n < 0) fail(shown_, mendFor(errno, folder_));
      done += static_cast<size_t>(n);
    }
  }

  int64_t seek(int64_t offset, int whence) {
    const off_t at = ::lseek(descriptor_, offset, whence);
    if (at < 0) fail(shown_, mendFor(errno, folder_));
    return at;
  }

  void flush() {
    if (::fsync(descriptor_) != 0 && errno != EINVAL) fail(shown_, mendFor(errno, folder_));
  }

  void commitAs(const fs::path& file) {
    const int closed = ::close(descriptor_);
    descriptor_ = -1;
    if (closed != 0) fail(shown_, mendFor(errno, folder_));
    if (::rename(name_.c_str(), file.c_str()) != 0) {
      fail(shown_, errno == ENAMETOOLONG ? "the name is too long; choose a shorter one" : mendFor(errno, folder_));
    }
    name_.clear();
  }

 private:
  const std::string shown_;
  const fs::path folder_;
  fs::path name_;
  int descriptor_ = -1;
};

/// Buffers what a stream writes.
class FileBuffer : public std::streambuf {
 public:
  explicit FileBuffer(TemporaryFile& file) : file_(file), bytes_(kBytes) { setp(bytes_.data(), bytes_.data() + bytes_.size()); }

 protected:
  int_type overflow(int_type c) override {
    drain();
    if (!traits_type::eq_int_type(c, traits_type::eof())) sputc(traits_type::to_char_type(c));
    return traits_type::not_eof(c);
  }
  std::streamsize xsputn(const char* from, std::streamsize count) override {
    if (count <= epptr() - pptr()) return std::streambuf::xsputn(from, count);
    drain();
    file_.write(from, static_cast<size_t>(count));
    return count;
  }
  int sync() override {
    drain();
    return 0;
  }
  pos_type seekoff(off_type offset, std::ios_base::seekdir from, std::ios_base::openmode) override {
    drain();
    return pos_type(file_.seek(offset, from == std::ios_base::beg ? SEEK_SET : from == std::ios_base::cur ? SEEK_CUR : SEEK_END));
  }
  pos_type seekpos(pos_type at, std::ios_base::openmode which) override { return seekoff(off_type(at), std::ios_base::beg, which); }

 private:
  void drain() {
    const auto count = static_cast<size_t>(pptr() - pbase());
    setp(bytes_.data(), bytes_.data() + bytes_.size());
    file_.write(bytes_.data(), count);
  }
  static constexpr size_t kBytes = size_t{1} << 18;
  TemporaryFile& file_;
  std::vector<char> bytes_;
};

}  // namespace

struct AtomicFile::Impl {
  explicit Impl(const std::string& path) : target(findTarget(path)), file(target, path), buffer(file), stream(&buffer) {
    // Without this a stream would swallow what its buffer throws.
    stream.exceptions(std::ios_base::badbit | std::ios_base::failbit);
  }
  Target target;
  TemporaryFile file;
  FileBuffer buffer;
  std::ostream stream;
};

AtomicFile::AtomicFile(const std::string& path) : impl_(std::make_unique<Impl>(path)) {}
AtomicFile::~AtomicFile() = default;
std::ostream& AtomicFile::stream() { return impl_->stream; }

uint64_t AtomicFile::commit() {
  impl_->stream.flush();
  const auto bytes = static_cast<uint64_t>(impl_->file.seek(0, SEEK_END));
  impl_->file.flush();
  impl_->file.commitAs(impl_->target.file);
  return bytes;
}

void writeFileAtomically(const std::string& path, const std::string& bytes) {
  const Target target = findTarget(path);
  TemporaryFile file(target, path);
  file.write(bytes.data(), bytes.size());
  file.flush();
  file.commitAs(target.file);
}

void checkWritable(const std::string& path) {
  const Target target = findTarget(path);
  // Trying is the only answer that holds for every user, mount and quota.
  TemporaryFile probe(target, path);
  struct stat info {};
  if (::lstat(target.file.c_str(), &info) != 0 && errno == ENAMETOOLONG) fail(path, "the name is too long; choose a shorter one");
}

}  // namespace radivox::image
