// A job's files, and downloads that need the access token: a link cannot send headers, so the page fetches the file
// and hands it to the browser. The whole file passes through memory.
import { request } from "./client";
import type { JobLinks } from "./types";

/** The address of a job's file; folders keep their slashes. */
export function fileAddress(links: JobLinks, name: string): string {
  return `${links.files}/${name.split("/").map(encodeURIComponent).join("/")}`;
}

export async function download(href: string, name: string): Promise<void> {
  const response = await request(href, { headers: { Accept: "*/*" } });
  const address = URL.createObjectURL(await response.blob());
  const link = document.createElement("a");
  link.href = address;
  link.download = name.split("/").at(-1) ?? name;
  link.click();
  // The browser reads the address after the click has returned.
  setTimeout(() => URL.revokeObjectURL(address), 60_000);
}
