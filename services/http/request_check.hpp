#pragma once

#include <boost/asio/ip/address.hpp>
#include <boost/beast/http.hpp>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "services/http/http_server.hpp"

namespace aloft::http {

using Request = boost::beast::http::request<boost::beast::http::string_body>;
using Response = boost::beast::http::response<boost::beast::http::string_body>;

/// The names under which a server answers.
class HostNames {
 public:
  /// `bound`: the address that it listens on; `names`: further names.
  HostNames(const boost::asio::ip::address& bound, std::vector<std::string> names);

  /// What is wrong with the Host or the Origin of this request, or nothing.
  [[nodiscard]] std::optional<Response> refusal(const Request& request) const;

 private:
  [[nodiscard]] bool knows(std::string_view name) const;

  bool any_address_;
  std::vector<std::string> names_;
};

/// The answer to a request that cannot be read; none if its sender has left or is too slow.
[[nodiscard]] std::optional<Response> refusal_of(const boost::system::error_code& error);

/// Whether the request has the header "Authorization: Bearer TOKEN". How long this takes does not tell the token.
[[nodiscard]] bool shows_token(const Request& request, std::string_view token);

/// The path and the query of a request's target.
[[nodiscard]] HttpRequest parsed(std::string_view target);

}  // namespace aloft::http
