/**
 * Requests to the daemon, always to this origin. Failures are errors with one sentence that can be
 * shown, and the HTTP status.
 */

const TIMEOUT_MS = 10000;

export class ApiError extends Error {
  constructor(message, status = 0) {
    super(message);
    this.status = status;
  }
}

async function answer_of(path, options) {
  let response;
  try {
    response = await fetch(path, {
      cache: "no-store",
      credentials: "omit",
      redirect: "error",
      signal: AbortSignal.timeout(TIMEOUT_MS),
      ...options,
    });
  } catch {
    throw new ApiError("the daemon does not answer");
  }
  let body = null;
  try {
    body = await response.json();
  } catch {
    // Said below, by the status.
  }
  if (typeof body?.answer === "string") {
    return body; // of a command: accepted or refused, with the reason
  }
  if (!response.ok) {
    throw new ApiError(body?.error?.message ?? `HTTP status ${response.status}`, response.status);
  }
  if (body === null || typeof body !== "object") {
    throw new ApiError("the daemon's answer broke off", response.status);
  }
  return body;
}

export function query(parameters) {
  const known = Object.entries(parameters).filter(([, v]) => v !== null && v !== undefined);
  return known.length === 0 ? "" : `?${new URLSearchParams(known)}`;
}

export function get(path, parameters = {}, token = null) {
  const headers = token === null ? {} : { Authorization: `Bearer ${token}` };
  return answer_of(path + query(parameters), { headers });
}

export function post(path, body, token) {
  return answer_of(path, {
    method: "POST",
    headers: { "Content-Type": "application/json", Authorization: `Bearer ${token}` },
    body: JSON.stringify(body),
  });
}

export function bench_path(bench, rest = "") {
  return `/api/bench/${encodeURIComponent(bench)}${rest}`;
}
