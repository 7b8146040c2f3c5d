/**
 * Keeps the page up to date: one stream of server-sent events, closed while the page is hidden and
 * opened again after the daemon was away. Where the daemon has no room for one more listener the
 * page asks once a second instead, and tries the stream again from time to time.
 */

import { bench_path, get, query } from "./api.js";

const REOPEN_MS = 1000;
const POLL_MS = 1000;
const POLLS_BEFORE_STREAM = 15;
const MAX_SILENCE_MS = 4000; // the daemon gives a sign of life every second
const EVENTS = ["laboratory", "bench", "run", "signal"];

export class Connection {
  /**
   * @param {(name: string, data: object) => void} on_data
   * @param {(state: "connecting"|"live"|"polling"|"lost"|"hidden") => void} on_state
   */
  constructor(on_data, on_state) {
    this.on_data = on_data;
    this.on_state = on_state;
    this.wants = {};
    this.source = null;
    this.timer = null;
    this.polls = 0;
    this.heard_ms = 0;
    this.generation = 0; // answers to what is no longer wanted are dropped
    document.addEventListener("visibilitychange", () => this.reopen());
    setInterval(() => this.check_silence(), 1000);
  }

  /** wants: {bench, signal, columns, seconds}, all of them optional. */
  watch(wants) {
    if (this.source !== null && JSON.stringify(wants) === JSON.stringify(this.wants)) {
      return;
    }
    this.wants = wants;
    this.reopen();
  }

  close() {
    this.generation += 1;
    this.source?.close();
    this.source = null;
    clearTimeout(this.timer);
  }

  reopen() {
    this.close();
    if (document.hidden) {
      this.on_state("hidden");
    } else {
      this.open();
    }
  }

  open() {
    const source = new EventSource(`/events${query(this.wants)}`);
    this.source = source;
    this.heard_ms = performance.now();
    source.addEventListener("open", () => this.on_state("live"));
    source.addEventListener("error", () => this.fail(source));
    for (const name of EVENTS) {
      source.addEventListener(name, (event) => this.receive(name, event.data));
    }
  }

  receive(name, text) {
    this.heard_ms = performance.now();
    let data;
    try {
      data = JSON.parse(text);
    } catch {
      return; // the next state comes within a second
    }
    this.on_data(name, data);
  }

  // A stream that was refused is closed; one that broke would be tried again by the browser, but at
  // a time of its own choice.
  fail(source) {
    if (source !== this.source) {
      return;
    }
    const was_refused = source.readyState === EventSource.CLOSED;
    this.close();
    if (was_refused) {
      this.polls = 0;
      this.poll();
      return;
    }
    this.on_state("lost");
    this.timer = setTimeout(() => this.reopen(), REOPEN_MS);
  }

  check_silence() {
    if (this.source !== null && performance.now() - this.heard_ms > MAX_SILENCE_MS) {
      this.close();
      this.on_state("lost");
      this.reopen();
    }
  }

  async poll() {
    const generation = this.generation;
    try {
      for (const asked of this.polled()) {
        const data = await answer_or_nothing(...asked.slice(1));
        if (generation !== this.generation) {
          return;
        }
        if (data !== null) {
          this.on_data(asked[0], data);
        }
      }
      this.on_state("polling");
      this.polls += 1;
    } catch {
      if (generation !== this.generation) {
        return;
      }
      this.on_state("lost");
      this.polls = POLLS_BEFORE_STREAM;
    }
    const next = this.polls >= POLLS_BEFORE_STREAM ? () => this.reopen() : () => this.poll();
    this.timer = setTimeout(next, POLL_MS);
  }

  polled() {
    const { bench, signal, columns, seconds } = this.wants;
    const asked = [["laboratory", "/api/laboratory", {}]];
    if (bench) {
      asked.push(["bench", bench_path(bench), {}], ["run", bench_path(bench, "/run"), {}]);
    }
    if (signal) {
      const [source, channel] = split_channel(signal);
      asked.push(["signal", bench_path(bench, "/signal"), { source, channel, columns, seconds }]);
    }
    return asked;
  }
}

// A bench or signal that is not there is no reason to believe that the daemon is away.
async function answer_or_nothing(path, parameters) {
  try {
    return await get(path, parameters);
  } catch (problem) {
    if (problem.status > 0) {
      return null;
    }
    throw problem;
  }
}

/** "dau/a/b" is channel "a/b" of source "dau". */
export function split_channel(name) {
  const slash = name.indexOf("/");
  return [name.slice(0, slash), name.slice(slash + 1)];
}
