#include "services/views/document/pdf.hpp"

#include <unistd.h>

#include <chrono>
#include <cstdlib>
#include <filesystem>
#include <optional>

#include <fmt/core.h>

#include "services/base/output_file.hpp"
#include "services/base/temporary_folder.hpp"
#include "services/base/whole_file.hpp"
#include "services/daemon/program/child_process.hpp"

namespace dyncal::inline views {
namespace {

constexpr std::chrono::minutes patience{2};
constexpr std::uintmax_t max_pdf_bytes = 1U << 28U;

std::optional<std::filesystem::path> find_program(const std::string& name) {
  const char* folders = std::getenv("PATH");
  std::string rest = folders == nullptr ? "/usr/local/bin:/usr/bin:/bin" : folders;
  while (!rest.empty()) {
    const std::size_t colon = rest.find(':');
    const std::filesystem::path candidate = std::filesystem::path(rest.substr(0, colon)) / name;
    rest = colon == std::string::npos ? "" : rest.substr(colon + 1);
    if (candidate.is_absolute() && access(candidate.c_str(), X_OK) == 0) {
      return candidate;
    }
  }
  return std::nullopt;
}

Expected<void> run_weasyprint(const std::filesystem::path& program,
                              const std::filesystem::path& folder) {
  DYNCAL_TRY(auto child, ChildProcess::start(program,
                                             {"--quiet", "--encoding", "utf-8",
                                              (folder / "document.html").string(),
                                              (folder / "document.pdf").string()},
                                             {folder / "output", folder / "output"}));
  const auto end = child.wait_for(patience);
  if (!end) {
    return fail(ErrorCode::bad_file,
                fmt::format("weasyprint took more than {} min and was ended; the HTML report is "
                            "complete, and a browser can print it",
                            patience.count()));
  }
  if (end->status != 0) {
    return fail(ErrorCode::bad_file,
                fmt::format("weasyprint ended with status {}: {}", end->status, child.last_line()));
  }
  return {};
}

} // namespace

Expected<std::string> make_pdf(std::string_view html) {
  const auto program = find_program("weasyprint");
  if (!program) {
    return fail(ErrorCode::bad_file,
                "the program weasyprint, which makes the PDF, is not in PATH (Debian: apt install "
                "weasyprint); the HTML report is complete, and a browser can print it; --no-pdf "
                "asks for no PDF");
  }
  const TemporaryFolder folder;
  if (folder.path().empty()) {
    return fail(ErrorCode::bad_file, "no folder for temporary files can be made; set TMPDIR to one "
                                     "that can be written");
  }
  DYNCAL_TRY(write_output_file(folder.path() / "document.html", html));
  DYNCAL_TRY(run_weasyprint(*program, folder.path()));
  auto pdf = read_whole_file(folder.path() / "document.pdf", max_pdf_bytes);
  if (pdf && !pdf->starts_with("%PDF-")) {
    return fail(ErrorCode::bad_file, "weasyprint wrote something that is not a PDF; the HTML "
                                     "report is complete, and a browser can print it");
  }
  return pdf;
}

} // namespace dyncal::inline views
