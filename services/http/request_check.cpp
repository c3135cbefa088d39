#include "services/http/request_check.hpp"

#include <algorithm>
#include <boost/algorithm/string/predicate.hpp>

#include "common/base/process_name.hpp"

namespace aloft::http {
namespace {

namespace beast_http = boost::beast::http;
using boost::system::error_code;

/// The name in "name:port" or "[::1]:port"; the port does not count, because a tunnel can change it.
std::string_view without_port(std::string_view host) {
  if (host.starts_with('[')) {
    const std::size_t end = host.find(']');
    return end == std::string_view::npos ? host : host.substr(1, end - 1);
  }
  return host.substr(0, host.find(':'));
}

Response refused(beast_http::status status, const char* why) {
  Response response;
  response.result(status);
  response.body() = why;
  return response;
}

}  // namespace

HostNames::HostNames(const boost::asio::ip::address& bound, std::vector<std::string> names)
    : any_address_(!bound.is_loopback()), names_(std::move(names)) {
  names_.emplace_back("localhost");
  if (any_address_) names_.push_back(this_process().host);
}

std::optional<Response> HostNames::refusal(const Request& request) const {
  const auto count = request.count(beast_http::field::host);
  // HTTP/1.0 clients need not send a Host; browsers do.
  if (count != 1 && (count != 0 || request.version() >= 11))
    return refused(beast_http::status::bad_request, "a request names one Host\n");
  const std::string_view host(request[beast_http::field::host].data(), request[beast_http::field::host].size());
  if (count == 1 && !knows(without_port(host)))
    return refused(beast_http::status::misdirected_request,
                   "this server does not answer under that name: use its address, or start it with --http-host NAME\n");
  // A browser names the page that asks; it must be one of this server.
  for (const auto& field : request)
    if (field.name() == beast_http::field::origin &&
        !boost::algorithm::iends_with(field.value(), "://" + std::string(host)))
      return refused(beast_http::status::forbidden, "pages of other origins get nothing from this server\n");
  return std::nullopt;
}

bool HostNames::knows(std::string_view name) const {
  error_code no_address;
  const boost::asio::ip::address address = boost::asio::ip::make_address(std::string(name), no_address);
  if (!no_address) return any_address_ || address.is_loopback();
  return std::ranges::any_of(names_, [&](const std::string& known) { return boost::algorithm::iequals(known, name); });
}

std::optional<Response> refusal_of(const error_code& error) {
  Response response;
  if (error == beast_http::error::header_limit || error == beast_http::error::buffer_overflow) {
    response.result(beast_http::status::request_header_fields_too_large);
  } else if (error == beast_http::error::body_limit) {
    response.result(beast_http::status::payload_too_large);
  } else if (error.category() == error_code(beast_http::error::bad_method).category() &&
             error != beast_http::error::end_of_stream && error != beast_http::error::partial_message) {
    response.result(beast_http::status::bad_request);
  } else {
    return std::nullopt;
  }
  response.body() = error.message() + "\n";
  return response;
}

bool shows_token(const Request& request, std::string_view token) {
  constexpr std::string_view scheme = "Bearer ";
  if (request.count(beast_http::field::authorization) != 1) return false;
  const auto field = request[beast_http::field::authorization];
  std::string_view shown(field.data(), field.size());
  if (!shown.starts_with(scheme)) return false;
  shown.remove_prefix(scheme.size());
  if (shown.size() != token.size()) return false;
  unsigned difference = 0;
  for (std::size_t i = 0; i < token.size(); ++i)
    difference |= static_cast<unsigned char>(shown[i]) ^ static_cast<unsigned>(static_cast<unsigned char>(token[i]));
  return difference == 0;
}

HttpRequest parsed(std::string_view target) {
  HttpRequest request;
  const std::size_t mark = std::min(target.find('?'), target.size());
  request.path = target.substr(0, mark);
  std::string_view rest = target.substr(std::min(mark + 1, target.size()));
  while (!rest.empty()) {
    const std::string_view pair = rest.substr(0, rest.find('&'));
    rest.remove_prefix(std::min(pair.size() + 1, rest.size()));
    const std::size_t equals = std::min(pair.find('='), pair.size());
    request.query.emplace(pair.substr(0, equals), pair.substr(std::min(equals + 1, pair.size())));
  }
  return request;
}

}  // namespace aloft::http
