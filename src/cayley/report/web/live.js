// The page of `cayley view`: frames come from its server, also while a run goes on.

const POLL_SECONDS = 1;

/** Ask the server for frames that are not here yet. */
async function poll(scene, number) {
  for (;;) {
    const answer = await fetch(`frames?scene=${number}&from=${scene.frames}`);
    if (answer.status === 204) return;
    if (answer.status === 205) return location.reload(); // another run has taken the place of this one
    if (!answer.ok) throw new Error(await answer.text());
    scene.append(await unzipped(new Uint8Array(await answer.arrayBuffer())));
  }
}

/** Follow a run in progress. */
async function follow(player) {
  for (;;) {
    await new Promise((resolve) => setTimeout(resolve, 1000 * POLL_SECONDS));
    const before = player.scene.frames;
    const atEnd = player.now >= player.last;
    try {
      await poll(player.scene, player.number);
    } catch (error) {
      element("live").textContent = `The server does not answer (${error.message}).`;
      continue;
    }
    element("live").textContent = `Live: ${player.scene.frames} frames, up to t = ${shown(player.last)} s.`;
    if (player.scene.frames > before) player.grown(atEnd);
  }
}
