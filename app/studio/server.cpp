#include "studio/server.hpp"

#include "common.hpp"

#ifdef CSRBF_HAS_HTTPLIB

#include "process/interrupt.hpp"
#include "report/page_files.hpp"
#include "studio/browser.hpp"
#include "studio/child.hpp"
#include "studio/coarse.hpp"
#include "studio/guard.hpp"
#include "studio/job.hpp"
#include "studio/look.hpp"
#include "studio/work_folder.hpp"

#include "csrbf/core/error.hpp"
#include "csrbf/core/parallel.hpp"
#include "csrbf/io/files/atomic_file.hpp"
#include "csrbf/io/files/read_file.hpp"
#include "csrbf/io/files/text.hpp"
#include "csrbf/version.hpp"

#include <httplib.h>

#include <atomic>
#include <cstdio>
#include <fstream>
#include <mutex>
#include <thread>

namespace csrbf::app {
namespace fs = std::filesystem;
namespace {

using namespace std::chrono_literals;

constexpr Index most_points = 2'000'000;  // sent to the page unless it asks for fewer
constexpr const char* binary = "application/octet-stream";

// Makes the browser refuse to load or send anything elsewhere, and others to show the page in a frame.
constexpr const char* policy =
    "default-src 'none'; img-src 'self' data: blob:; style-src 'unsafe-inline'; script-src 'unsafe-inline'; "
    "connect-src 'self'; base-uri 'none'; form-action 'none'; frame-ancestors 'none'";

class Studio {
 public:
  explicit Studio(const StudioOptions& options)
      : options_(options), token_(random_token()), folder_(options.folder, options.files) {}

  void run();

 private:
  using Request = httplib::Request;
  using Response = httplib::Response;

  void add_routes();
  bool guard(const Request& request, Response& response) const;
  static void explain(Response& response, int status, const std::string& message);
  void explain(Response& response, const std::exception_ptr& error) const;

  Json entry(const std::string& name, const std::string& kind);
  Json item(const std::string& name);
  Json items(const std::vector<std::string>& names);
  std::string exact_kind(const std::string& name, std::string& problem);
  fs::path find(const std::string& name);

  void send_session(Response& response);
  void receive(const Request& request, Response& response, const httplib::ContentReader& reader);
  void send_file(const Request& request, Response& response);
  void send_look(const Request& request, Response& response);
  void start_job(const Request& request, Response& response);
  std::vector<std::string> coarse(std::vector<std::string> arguments);
  bool step(Job& job, httplib::DataSink& sink);
  void finish(Job& job, httplib::DataSink& sink);

  StudioOptions options_;
  std::string token_;
  std::mutex mutex_;  // of the folder and the kinds
  WorkFolder folder_;
  std::map<std::string, std::pair<fs::file_time_type, std::string> > kinds_;
  Looker looker_;
  Slots slots_;
  std::atomic<bool> stopping_ = false;
  httplib::Server server_;
};

bool send_event(httplib::DataSink& sink, const std::string& name, const Json& data) {
  const std::string text =
      "event: " + name + "\ndata: " + data.dump(-1, ' ', false, Json::error_handler_t::replace) + "\n\n";
  return sink.write(text.data(), text.size());
}

void send_json(httplib::Response& response, const Json& data) {
  response.set_content(data.dump(-1, ' ', false, Json::error_handler_t::replace), "application/json");
}

void Studio::explain(Response& response, int status, const std::string& message) {
  response.status = status;
  send_json(response, {{"error", message}});
}

void Studio::explain(Response& response, const std::exception_ptr& error) const {
  const Refused refused = refusal_of(error);
  explain(response, refused.status(), folder_.inside(refused.what()));
}

// Everything is answered to whoever has the token, from this machine, and to nobody else.
bool Studio::guard(const Request& request, Response& response) const {
  const std::string host = request.get_header_value("Host"), origin = request.get_header_value("Origin"),
                    site = request.get_header_value("Sec-Fetch-Site");
  constexpr int forbidden = 403;
  if (!is_local_request({host, origin, site}, options_.port)) {
    explain(response, forbidden, "only pages of this studio may ask it");
    return false;
  }
  if (path_below_token(request.path, token_) == nullptr) {
    explain(response, forbidden, "the address lacks the studio's token; take the one that the program printed");
    return false;
  }
  return true;
}

fs::path Studio::find(const std::string& name) {
  const std::lock_guard lock(mutex_);
  return folder_.find(name);
}

std::string Studio::exact_kind(const std::string& name, std::string& problem) {
  try {
    const fs::path path = folder_.find(name);
    const fs::file_time_type time = fs::last_write_time(path);
    const auto known = kinds_.find(name);
    if (known != kinds_.end() && known->second.first == time) return known->second.second;
    if (name.find('/') != std::string::npos || kind_by_name(name) == "other") return kind_by_name(name);
    std::string kind = looker_.look(path, 1).header["kind"];
    kinds_[name] = {time, kind};
    return kind;
  } catch (const std::exception& error) {
    problem = folder_.inside(error.what());
    return "other";
  }
}

Json Studio::entry(const std::string& name, const std::string& kind) {
  std::error_code error;
  const fs::path path = folder_.find(name);
  const auto written = fs::last_write_time(path, error).time_since_epoch() / 1ms;
  return {{"name", name},
          {"kind", kind},
          {"bytes", fs::file_size(path, error)},
          {"written", written},
          {"made", folder_.is_made(name) || name.starts_with("preview:")}};
}

Json Studio::item(const std::string& name) {
  std::string problem;
  Json item = entry(name, exact_kind(name, problem));
  if (!problem.empty()) item["problem"] = problem;
  return item;
}

Json Studio::items(const std::vector<std::string>& names) {
  Json all = Json::array();
  for (const std::string& name : names) all.push_back(item(name));
  return all;
}

void Studio::send_session(Response& response) {
  const std::lock_guard lock(mutex_);
  Json files = Json::array();
  constexpr std::size_t few = 20;  // files that are looked into; of more, the names tell
  const std::vector<std::string> names = folder_.names();
  std::error_code error;
  for (const std::string& name : names)
    if (fs::exists(folder_.path() / name, error))
      files.push_back(names.size() <= few ? item(name) : entry(name, kind_by_name(name)));
  send_json(response, {{"engine", "native"},
                       {"version", CSRBF_VERSION},
                       {"folder", folder_.is_temporary() ? Json() : Json(folder_.path().string())},
                       {"largest", options_.largest},
                       {"threads", thread_count()},
                       {"files", files}});
}

void Studio::receive(const Request& request, Response& response, const httplib::ContentReader& reader) {
  constexpr int too_large = 413, incomplete = 400;
  const std::string name = request.matches[1];
  const std::string said = request.get_header_value("Content-Length");
  if (!said.empty() && parse_number(said).value_or(0) > static_cast<double>(options_.largest))
    throw Refused(too_large, name + " is larger than " + std::to_string(options_.largest) +
                                 " bytes; csrbf studio --largest SIZE allows more");
  fs::path path;
  {
    const std::lock_guard lock(mutex_);
    path = request.has_param("replace") ? folder_.writable(name) : folder_.fresh(name);
  }
  try {
    AtomicFile file(path.string());
    std::size_t received = 0;
    bool fits = true;
    const bool whole = reader([&](const char* data, std::size_t size) {
      received += size;
      fits = received <= options_.largest;
      if (fits) file.write({data, size});
      return fits;
    });
    if (!fits) throw Refused(too_large, name + " is too large; csrbf studio --largest SIZE allows more");
    if (!whole) throw Refused(incomplete, name + " did not arrive completely");
    file.commit();
  } catch (...) {
    const std::lock_guard lock(mutex_);
    std::error_code error;
    if (!fs::exists(path, error)) folder_.forget(path.filename().string());
    throw;
  }
  const std::lock_guard lock(mutex_);
  send_json(response, item(path.filename().string()));
}

void Studio::send_file(const Request& request, Response& response) {
  const fs::path path = find(request.matches[1]);
  const auto file = std::make_shared<std::ifstream>(path, std::ios::binary);
  if (!*file) throw IoError(path.filename().string() + ": cannot be read");
  // A report would be a page of this server: it is saved, not shown.
  response.set_header("Content-Disposition", "attachment");
  response.set_content_provider(fs::file_size(path), binary,
                                [file](std::size_t offset, std::size_t length, httplib::DataSink& sink) {
                                  constexpr std::size_t most = 1U << 20U;
                                  std::string part(std::min(length, most), '\0');
                                  file->seekg(static_cast<std::streamoff>(offset));
                                  if (!file->read(part.data(), static_cast<std::streamsize>(part.size()))) return false;
                                  return sink.write(part.data(), part.size());
                                });
}

Index whole_number(const httplib::Request& request, const char* name, Index otherwise) {
  if (!request.has_param(name)) return otherwise;
  const std::optional<double> number = parse_number(request.get_param_value(name));
  require(number && *number >= 0 && *number <= 1e12 && *number == std::floor(*number), "studio", name,
          request.get_param_value(name), "must be a whole number");
  return static_cast<Index>(*number);
}

void Studio::send_look(const Request& request, Response& response) {
  const fs::path path = find(request.matches[1]);
  const auto number = [&](const char* name) { return whole_number(request, name, 0); };
  const Look look = request.has_param("axis")
                        ? looker_.slice(path, static_cast<int>(number("axis")), number("index"), number("frame"))
                        : looker_.look(path, whole_number(request, "most", most_points));
  response.set_content(look.bytes(), binary);
}

// Arguments that name inputs, with the names of coarse copies; the others as they are.
std::vector<std::string> Studio::coarse(std::vector<std::string> arguments) {
  const std::vector<std::string> names = folder_.names();
  for (std::string& argument : arguments)
    for (const std::string& name : names)
      if (argument == name || argument.ends_with(":" + name)) {
        std::error_code error;
        if (!fs::is_regular_file(folder_.path() / name, error)) continue;
        argument.replace(argument.size() - name.size(), name.size(),
                         coarse_copy(folder_.path() / name, folder_.preview_path()));
        break;
      }
  return arguments;
}

void Studio::start_job(const Request& request, Response& response) {
  auto [arguments, preview] = parse_job(request.body);
  {
    const std::lock_guard lock(mutex_);
    folder_.check(arguments);
    if (preview) arguments = coarse(arguments);
  }
  const auto job = std::make_shared<Job>(std::move(arguments), preview, slots_);
  response.set_header("Cache-Control", "no-store");
  response.set_chunked_content_provider("text/event-stream", [this, job](std::size_t, httplib::DataSink& sink) {
    try {
      return step(*job, sink);
    } catch (const std::exception& error) {
      send_event(sink, "done", {{"status", 1}, {"error", error.what()}});
      sink.done();
      return true;
    }
  });
}

// One turn of the loop that sends the events of a job. False ends the connection, and with it the job.
bool Studio::step(Job& job, httplib::DataSink& sink) {
  constexpr std::string_view alive = ": alive\n\n";
  if (stopping_) return false;
  if (!job.is_running()) {
    if (!job.take_slot()) {
      std::this_thread::sleep_for(50ms);
      return sink.write(alive.data(), alive.size());
    }
    const std::lock_guard lock(mutex_);
    job.start(folder_);
    return send_event(sink, "started", Json::object());
  }
  bool is_heard = true;
  const bool ended = job.wait([&](const std::string& stage, double fraction) {
    is_heard = is_heard && send_event(sink, "progress", {{"stage", stage}, {"fraction", fraction}});
  });
  if (!ended) return is_heard && sink.write(alive.data(), alive.size());
  finish(job, sink);
  return true;
}

void Studio::finish(Job& job, httplib::DataSink& sink) {
  Json outcome = job.outcome();
  {
    const std::lock_guard lock(mutex_);
    const std::vector<std::string> written = folder_.written_since(job.before(), job.preview());
    outcome["items"] = items(written);
  }
  send_event(sink, "done", outcome);
  sink.done();
}

void Studio::add_routes() {
  const auto route = [&](const std::string& rest) { return "/[^/]+/" + rest; };
  server_.set_pre_routing_handler([this](const Request& request, Response& response) {
    return guard(request, response) ? httplib::Server::HandlerResponse::Unhandled
                                    : httplib::Server::HandlerResponse::Handled;
  });
  server_.set_exception_handler(
      [this](const Request&, Response& response, std::exception_ptr error) { explain(response, error); });
  server_.Get(route(""), [](const Request&, Response& response) {
    response.set_header("Content-Security-Policy", policy);
    response.set_content(studio_page.data(), studio_page.size(), "text/html; charset=utf-8");
  });
  server_.Get(route("api/session"), [this](const Request&, Response& response) { send_session(response); });
  server_.Get(route("api/commands"), [this](const Request&, Response& response) {
    Child program({"--print-usage"}, folder_.path());
    while (!program.wait(heartbeat, nullptr)) continue;
    response.set_content(program.output(), "application/json");
  });
  server_.Get(route("api/look/(.+)"),
              [this](const Request& request, Response& response) { send_look(request, response); });
  server_.Get(route("api/files/(.+)"),
              [this](const Request& request, Response& response) { send_file(request, response); });
  server_.Put(route("api/files/(.+)"),
              [this](const Request& request, Response& response, const httplib::ContentReader& reader) {
                receive(request, response, reader);
              });
  server_.Delete(route("api/files/(.+)"), [this](const Request& request, Response& response) {
    const std::lock_guard lock(mutex_);
    folder_.remove(request.matches[1]);
    send_json(response, Json::object());
  });
  server_.Post(route("api/run"), [this](const Request& request, Response& response) { start_job(request, response); });
}

void Studio::run() {
  add_routes();
  // No other program may listen on the same port.
  server_.set_socket_options([](int socket) {
    const int yes = 1;
    setsockopt(socket, SOL_SOCKET, SO_REUSEADDR, &yes, sizeof yes);
  });
  server_.set_keep_alive_max_count(1);  // what was not read of a refused request is no request of its own
  server_.set_payload_max_length(options_.largest);
  server_.set_default_headers({{"X-Content-Type-Options", "nosniff"},
                               {"Referrer-Policy", "no-referrer"},
                               {"Cross-Origin-Resource-Policy", "same-origin"},
                               {"Cross-Origin-Opener-Policy", "same-origin"}});
  const char* machine = "127.0.0.1";
  if (options_.port == 0)
    options_.port = server_.bind_to_any_port(machine);
  else if (!server_.bind_to_port(machine, options_.port))
    throw UsageError("--port " + std::to_string(options_.port) + ": it is in use; take another one, or leave it out");
  if (options_.port <= 0) throw UsageError("studio: no free port on 127.0.0.1");
  const std::string address = "http://127.0.0.1:" + std::to_string(options_.port) + "/" + token_ + "/";
  std::thread listener([this] { server_.listen_after_bind(); });
  std::printf("The studio is at %s\nCtrl-C ends it.\n", address.c_str());
  std::fflush(stdout);
  while (!server_.is_running()) std::this_thread::sleep_for(1ms);  // or stop() does nothing
  if (options_.opens_browser) open_in_browser(address);
  while (!interrupted()) std::this_thread::sleep_for(50ms);
  stopping_ = true;
  server_.stop();
  listener.join();
}

}  // namespace

void serve_studio(const StudioOptions& options) {
  if (studio_page.empty())
    throw UsageError(
        "this csrbf was built without the studio's page: install three.js and esbuild (Debian: libjs-three esbuild) "
        "and "
        "build it again");
  Studio(options).run();
}

}  // namespace csrbf::app

#endif
