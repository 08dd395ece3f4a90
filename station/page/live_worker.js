// SPDX-License-Identifier: Apache-2.0
// Holds the WebSocket, so that a page that draws slowly still takes what comes; connects again by itself.
const protocol = 'aussois.live.1', waits = [250, 500, 1000, 2000, 4000];
let socket = null, tries = 0, hello = null, ended = false;

function connect(url) {
  socket = new WebSocket(url, protocol);
  socket.binaryType = 'arraybuffer';
  socket.onopen = () => { tries = 0; socket.send(JSON.stringify(hello)); };
  socket.onmessage = ({ data }) => {
    if (typeof data !== 'string') { postMessage({ bytes: data }, [data]); return; }
    const text = JSON.parse(data);
    if (text.kind === 'closing') ended = true;
    postMessage({ text });
  };
  socket.onclose = ({ code, reason }) => {
    const again = !ended && code !== 1008;
    postMessage({ closed: { code, reason, again } });
    if (again) setTimeout(connect, waits[Math.min(tries++, waits.length - 1)], url);
  };
}

onmessage = ({ data }) => {
  if (data.open) { hello = data.hello; connect(data.open); return; }
  if (data.have) { hello.have = data.have; return; }
  if (socket?.readyState !== WebSocket.OPEN) return;
  socket.send(data.bytes ?? JSON.stringify(data.text));
};
