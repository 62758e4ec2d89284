// The page of `cayley view`: frames come from its server, also while a run goes on.

const POLL_SECONDS = 1;

/** Ask the server for frames that are not here yet; says whether there were any. */
async function more(scene, number) {
  const answer = await fetch(`frames?scene=${number}&from=${scene.frames}`);
  if (answer.status === 204) return false;
  if (answer.status === 205) return location.reload(); // another run has taken the place of this one
  if (!answer.ok) throw new Error(await answer.text());
  scene.append(await unzipped(new Uint8Array(await answer.arrayBuffer())));
  return true;
}

/** Follow a run in progress. */
async function follow(player) {
  for (let came = false; ; ) {
    if (!came) await new Promise((resolve) => setTimeout(resolve, 1000 * POLL_SECONDS));
    const atEnd = player.now >= player.last;
    try {
      came = await more(player.scene, player.number);
    } catch (error) {
      came = false;
      element("live").textContent = `The server does not answer (${error.message}).`;
      continue;
    }
    if (came) player.grown(atEnd);
    element("live").textContent = `Live: ${player.scene.frames} frames, up to t = ${shown(player.last)} s.`;
  }
}
